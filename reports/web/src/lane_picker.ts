// SPDX-License-Identifier: Apache-2.0
// Chooses lanes by algorithm, scalar and target. A lane is shown if all three rows of buttons allow it. The URL stores
// choices that differ from the default; their names contain `key`: "league-target=cpu,cpu-fma".
import { button, h } from './dom';
import type { Report } from './report';
import { choose, chosen, when_chosen } from './state';

type Part = 'algorithm' | 'scalar' | 'target';
const kParts: Part[] = ['algorithm', 'scalar', 'target'];

export interface Picker {
  element: HTMLElement;
  lanes: () => number[];
}

export function lane_picker(
  report: Report,
  key: string,
  initial: Partial<Record<Part, string[]>>,
  change: () => void,
  swatch?: (algorithm: string) => string,
): Picker {
  const picked = {} as Record<Part, Set<string>>;
  const rereads: (() => void)[] = [];
  const rows = kParts.map((part) => {
    const values = [...new Set(report.lanes.map((lane) => lane[part]))];
    const wanted = initial[part]?.filter((value) => values.includes(value));
    const first = wanted?.length ? wanted : values;
    const listed = () => values.filter((value) => picked[part].has(value)).join(',');
    const buttons = values.map((value) =>
      button(
        [
          part === 'algorithm' && swatch ? h('i', { class: 'swatch', style: `background:${swatch(value)}` }) : null,
          value,
        ],
        () => {
          if (!picked[part].delete(value)) picked[part].add(value);
          choose(
            `${key}-${part}`,
            listed() === values.filter((one) => first.includes(one)).join(',') ? '' : listed() || 'none',
          );
          show();
          change();
        },
      ),
    );
    const show = () =>
      buttons.forEach((button, i) => button.setAttribute('aria-pressed', String(picked[part].has(values[i]))));
    const reread = () => {
      const kept = chosen(`${key}-${part}`);
      picked[part] = new Set(kept ? kept.split(',').filter((value) => values.includes(value)) : first);
      show();
    };
    reread();
    rereads.push(reread);
    return h('div', { class: 'chips', role: 'group', 'aria-label': part }, h('span', {}, part), buttons);
  });
  when_chosen(() => {
    rereads.forEach((reread) => reread());
    change();
  });
  return {
    element: h('div', { class: 'picker' }, rows),
    lanes: () => report.lanes.flatMap((lane, i) => (kParts.every((part) => picked[part].has(lane[part])) ? [i] : [])),
  };
}
