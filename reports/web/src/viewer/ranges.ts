// SPDX-License-Identifier: Apache-2.0
// Extracts from a lane's steps the ranges of both triangles that it compared on a line: intervals on the line where the
// planes meet, or projections on axes. Adds the same ranges computed with 113 bits.
import type { Step } from './graze.js';

export type Ends = [number, number]; // low, high
export interface Ranges {
  name: string;
  a: Ends;
  b: Ends;
  exact_a: Ends;
  exact_b: Ends;
}

const kEdges = ['[0] [1]', '[1] [2]', '[2] [0]'];
const edge = (of: string, i: number) => `edge ${of}${kEdges[i]}`;
// The axes, in the order in which the algorithms test them.
const kSeventeen = [
  'normal of a',
  'normal of b',
  ...[0, 1, 2].flatMap((i) => [0, 1, 2].map((j) => `${edge('a', i)} × ${edge('b', j)}`)),
  ...[0, 1, 2].flatMap((i) => [`across ${edge('a', i)} in its plane`, `across ${edge('b', i)} in its plane`]),
];
const kSix = [0, 1, 2]
  .flatMap((i) => [`across ${edge('a', i)}`, `across ${edge('b', i)}`])
  .map((name) => `${name}, in the plane of a`);

// Sorts two numbers as the algorithms do, even if one is NaN.
const sorted = (x: number, y: number): Ends => (x < y ? [x, y] : [y, x]);
const span = ([first, ...rest]: number[]): Ends =>
  rest.reduce(([low, high], t) => [t < low ? t : low, t > high ? t : high], [first, first]);
const same = (x: number, y: number) => x === y || (Number.isNaN(x) && Number.isNaN(y));

// The ends of both triangles' ranges, from the comparisons that sorted the ends. Swaps the ranges if they match
// the step only when swapped.
function in_order(
  name: string,
  [one, other]: { lane: Ends; exact: Ends }[],
  fits: (a: Ends, b: Ends) => boolean,
): Ranges | null {
  for (const [a, b] of [
    [one, other],
    [other, one],
  ]) {
    if (fits(a.lane, b.lane)) return { name, a: a.lane, b: b.lane, exact_a: a.exact, exact_b: b.exact };
  }
  return null;
}

// The intervals on the line where the planes meet.   Returns: null if the lane decided before it computed them.
export function intervals(run: Step[]): Ranges | null {
  const at = run.findIndex((step) => step.site === 'separation' && step.relation);
  if (at < 0) return null;
  const before = run.slice(0, at).filter((step) => step.relation),
    line = before.at(-1)?.line,
    { left, right, relation } = run[at];
  const two = before
    .filter((step) => step.line === line)
    .slice(-2)
    .map((step) => ({ lane: sorted(step.left, step.right), exact: sorted(step.exactLeft, step.exactRight) }));
  // moller_1997 asks whether a ends before b begins; interval_overlap asks whether a begins before b does.
  return two.length < 2
    ? null
    : in_order(
        'the line where the planes meet',
        two,
        (a, b) => same(relation === '<' ? a[1] : a[0], left) && same(b[0], right),
      );
}

// The projections on each axis that the lane tested.
export function projections(run: Step[], subject: string): Ranges[] {
  const all: Ranges[] = [],
    names = subject === 'separating_axes' ? kSeventeen : kSix;
  let seen: Step[] = [];
  for (const step of run) {
    if (step.site === 'separation' && seen.length === 8) {
      // four comparisons order the three vertices of each triangle
      const two = [seen.slice(0, 4), seen.slice(4)].map((of) => ({
        lane: span([of[0].right, of[0].left, of[2].left]),
        exact: span([of[0].exactRight, of[0].exactLeft, of[2].exactLeft]),
      }));
      const found = in_order(
        names[all.length] ?? `axis ${all.length + 1}`,
        two,
        (a, b) => same(a[1], step.left) && same(b[0], step.right),
      );
      if (!found) return [];
      all.push(found);
      seen = [];
    } else if (step.relation && !step.site) {
      seen = step.line.startsWith('core/algorithms/range.h:') ? [...seen, step] : [];
    }
  }
  return all;
}

// The gap between two ranges; negative if they overlap.
export const gap = (a: Ends, b: Ends) => Math.max(b[0] - a[1], a[0] - b[1]);
export const lane_gap = ({ a, b }: Ranges) => gap(a, b);
export const exact_gap = ({ exact_a, exact_b }: Ranges) => gap(exact_a, exact_b);

// The axis to show first: one that separates in the lane, otherwise one that separates with 113 bits, otherwise the one
// with the least overlap.
export function telling(all: Ranges[]): number {
  const size = ({ a, b }: Ranges) => Math.max(a[1], b[1]) - Math.min(a[0], b[0]) || 1;
  for (const of of [lane_gap, exact_gap]) {
    const parts = all.findIndex((ranges) => of(ranges) > 0);
    if (parts >= 0) return parts;
  }
  const share = all.map((ranges) => lane_gap(ranges) / size(ranges)).map((x) => (Number.isNaN(x) ? -Infinity : x));
  return share.indexOf(Math.max(...share));
}
