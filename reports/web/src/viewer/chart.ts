// SPDX-License-Identifier: Apache-2.0
// Draws two ranges on a line: first as a whole, then magnified where their ends are closest to each other.
import { figure } from '../format';
import { node } from '../projection';
import type { Ends } from './ranges';

export interface Row {
  name: string;
  a: Ends;
  b: Ends;
}

const kMargin = 8,
  kRow = 34,
  kMostTicks = 60;

// The two closest ends, one of each range.
const critical = ({ a, b }: Row): [number, number] => (b[0] - a[1] > a[0] - b[1] ? [a[1], b[0]] : [b[1], a[0]]);

// ulp: the distance between neighbouring numbers of the lane.
export function chart(rows: Row[], ulp: (at: number) => number, width: number) {
  const all = rows.flatMap(({ a, b }) => [...a, ...b]),
    low = Math.min(...all),
    high = Math.max(...all),
    whole = (high - low) / 2 || 1;
  const ends = rows.flatMap(critical),
    middle = (Math.min(...ends) + Math.max(...ends)) / 2;
  const half = Math.min(whole, Math.max(0.8 * (Math.max(...ends) - Math.min(...ends)), 3 * ulp(middle)));
  const views = [
    { centre: low / 2 + high / 2, half: 1.04 * whole },
    ...(half < whole / 4 ? [{ centre: middle, half }] : []),
  ];
  const svg = node('svg', { width, height: views.length * (rows.length * kRow + 12), class: 'ranges' });
  views.forEach(({ centre, half: reach }, v) => {
    const top = v * (rows.length * kRow + 12),
      x = (at: number) =>
        width / 2 + (Math.min(1.5, Math.max(-1.5, (at - centre) / reach)) * (width - 2 * kMargin)) / 2;
    const step = ulp(centre);
    if (v && reach / step < kMostTicks / 2) {
      for (let i = Math.ceil((centre - reach) / step); i * step <= centre + reach; ++i)
        svg.append(
          node('line', {
            x1: x(i * step),
            x2: x(i * step),
            y1: top + 12,
            y2: top + rows.length * kRow + 4,
            class: 'ulp',
          }),
        );
    }
    rows.forEach(({ name, a, b }, r) => {
      const y = top + r * kRow;
      svg.append(node('text', { x: kMargin, y: y + 9 }, v ? `${name}, × ${figure(whole / reach)}` : name));
      for (const [ends_of, at, of] of [
        [a, y + 14, 'a'],
        [b, y + 22, 'b'],
      ] as const) {
        const [from, to] = ends_of.map(x);
        svg.append(node('rect', { x: from, y: at, width: Math.max(1.5, to - from), height: 7, class: `range-${of}` }));
      }
    });
  });
  return svg;
}
