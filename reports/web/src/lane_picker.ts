// SPDX-License-Identifier: Apache-2.0
// Chooses lanes by algorithm, scalar and target: those are shown that all three rows of buttons allow.
import { h } from './dom';
import type { Report } from './report';

type Part = 'algorithm' | 'scalar' | 'target';
const kParts: Part[] = ['algorithm', 'scalar', 'target'];

export interface Picker {
  element: HTMLElement;
  lanes: () => number[];
}

export function lane_picker(report: Report, initial: Partial<Record<Part, string[]>>, change: () => void,
                            swatch?: (algorithm: string) => string): Picker {
  const chosen = {} as Record<Part, Set<string>>;
  const rows = kParts.map((part) => {
    const values = [...new Set(report.lanes.map((lane) => lane[part]))];
    const wanted = initial[part]?.filter((value) => values.includes(value));
    chosen[part] = new Set(wanted?.length ? wanted : values);
    const buttons = values.map((value) => {
      const button = h('button', { type: 'button', 'aria-pressed': String(chosen[part].has(value)), onclick: () => {
        if (!chosen[part].delete(value)) chosen[part].add(value);
        button.setAttribute('aria-pressed', String(chosen[part].has(value)));
        change();
      } }, part === 'algorithm' && swatch ? h('i', { class: 'swatch', style: `background:${swatch(value)}` }) : null, value);
      return button;
    });
    return h('div', { class: 'chips', role: 'group', 'aria-label': part }, h('span', {}, part), buttons);
  });
  return {
    element: h('div', { class: 'picker' }, rows),
    lanes: () => report.lanes.flatMap((lane, i) => (kParts.every((part) => chosen[part].has(lane[part])) ? [i] : [])),
  };
}
