// SPDX-License-Identifier: Apache-2.0
// The viewer's state: one pair, the chosen coordinate and lane, and the history.
import { from_bits, stored_as, to_bits, type_of_bits, type Coordinates, type Scalar } from './data';
import type { Graze, Margin, Truth, Verdict } from './graze.js';

export type Centre = 'both triangles' | 'the chosen vertex' | 'the contact or gap';
export const kCentres: Centre[] = ['both triangles', 'the chosen vertex', 'the contact or gap'];

// The thesis's special cases, in its order. Each case is a triangle B; all share one reference triangle.
const kReference = [0, -2, 6, 0, 5, 0, 0, -3, 0];
const kSpecial = [
  ['across the line', -2, -2, 0, 2, -3, 0, 3, -1, 0],
  ['across the line, other side', 2, -1, 0, -2, -1.5, 0, -3, 0, 0],
  ['a vertex on the edge', 0, 0, 0, -2, 0.5, 0, -3, 2, 0],
  ['a vertex on the edge, other side', 0, 0.5, 0, 2, 0, 0, 3, 1, 0],
  ['an edge within the edge', 3, 1.5, 0, 0, 1, 0, 0, 2, 0],
  ['an edge within the edge, other side', -3, 3, 0, 0, 2.5, 0, 0, 3.5, 0],
  ['a vertex on the line', -2, 4.7, 0, 0, 3.7, 0, 2, 4.7, 0],
  ['the reference pierces B', 1.5, -3, 5.5, -2, -2, 5.5, 1.5, 0, 5.5],
  ['B pierces the reference', 2, 0, 0.5, -2, 0, 1.5, 1, 0, 4],
  ['in the same plane', 0, 3, 1, 0, 1, 1.5, 0, 4, 3],
] as const;
// The coordinates are float32 numbers, even in pairs of doubles.
export const special_cases = (type: Scalar): { name: string; pair: Coordinates }[] =>
  kSpecial.map(([what, ...b], i) => ({
    name: `special case ${i + 1} of 2012: ${what}`,
    pair: stored_as(type, Float32Array.of(...kReference, ...b)),
  }));

export const without_changed = (name: string) => name.replace(/, changed$/, '');

export interface Decided {
  verdicts: Record<string, Verdict | null>;
  truth: Truth;
  margin: Margin;
  stored: Truth | null; // for doubles: the truth of the pair rounded to float32, if rounding changes the pair
}

export class Model {
  pair: Coordinates;
  name: string;
  chosen = 9; // index of the coordinate
  lane: string;
  policy = '';
  centre: Centre = 'both triangles';
  shows = { axes: false, coordinates: false, ids: true, planes: false };
  decided: Decided;
  private past: { pair: Coordinates; name: string }[] = [];
  private future: { pair: Coordinates; name: string }[] = [];
  private moving = false;

  // changed: called after each change; `moved` is true if the pair or the policy changed, not only the display.
  constructor(
    readonly graze: Graze,
    first: { name: string; pair: Coordinates },
    private changed: (moved: boolean) => void,
  ) {
    this.pair = first.pair;
    this.name = first.name;
    this.lane = graze.lanes[0];
    this.decided = this.decide();
  }

  private decide(): Decided {
    const { graze, pair } = this;
    const stored = pair.every((x) => Object.is(Math.fround(x), x)) ? null : graze.truth(Float32Array.from(pair));
    return { verdicts: graze.decide(pair), truth: graze.truth(pair), margin: graze.margin(pair), stored };
  }

  private settle() {
    this.decided = this.decide();
    this.changed(true);
  }

  // All changes between start_moving and stop_moving are undone in one step.
  start_moving() {
    this.remember();
    this.moving = true;
  }
  stop_moving() {
    this.moving = false;
  }
  private remember() {
    if (this.moving) return;
    this.past.push({ pair: this.pair, name: this.name });
    if (this.past.length > 1000) this.past.shift();
    this.future = [];
  }

  show(pair: Coordinates, name: string) {
    this.remember();
    this.pair = pair;
    this.name = name;
    this.settle();
  }
  change(edit: (pair: Coordinates) => void) {
    const next = this.pair.slice();
    edit(next);
    this.show(next, `${without_changed(this.name)}, changed`);
  }
  step(ulps: number) {
    this.change((pair) => (pair[this.chosen] = this.graze.nudged(pair[this.chosen], ulps)));
  }
  // Moves the first triangle, which is the thesis's reference.
  move_reference(axis: number, by: number) {
    this.change((pair) => [0, 3, 6].forEach((c) => (pair[c + axis] += by)));
  }
  travel(from: 'past' | 'future') {
    const [source, target] = from === 'past' ? [this.past, this.future] : [this.future, this.past];
    const next = source.pop();
    if (!next) return false;
    target.push({ pair: this.pair, name: this.name });
    [this.pair, this.name] = [next.pair, next.name];
    this.settle();
    return true;
  }
  can(travel: 'past' | 'future') {
    return (travel === 'past' ? this.past : this.future).length > 0;
  }
  set_policy(policy: string) {
    this.graze.set_policy(policy);
    this.policy = policy;
    this.settle();
  }
  // Changes the display only, not the decision.
  set(what: Partial<Pick<Model, 'chosen' | 'lane' | 'centre' | 'shows'>>) {
    Object.assign(this, what);
    this.changed(false);
  }
  toggle(what: keyof Model['shows']) {
    this.set({ shows: { ...this.shows, [what]: !this.shows[what] } });
  }

  wrong(lane: string) {
    const { verdicts, truth } = this.decided,
      verdict = verdicts[lane];
    return verdict !== null && truth.verdict !== 'declined' && verdict !== truth.verdict;
  }
  // Chooses the most interesting lane: a GPU lane that differs from the CPU, otherwise a wrong lane. If there is
  // neither, the choice does not change.
  choose_telling() {
    const { lanes } = this.graze;
    this.set({ lane: lanes.find((lane) => this.differs(lane)) ?? lanes.find((lane) => this.wrong(lane)) ?? this.lane });
  }
  // The same subject and scalar in another variant; undefined if there is none.
  counterpart(lane: string, variant: string) {
    const [subject, scalar] = lane.split('/'),
      other = `${subject}/${scalar}/${variant}`;
    return this.graze.lanes.includes(other) ? other : undefined;
  }
  // Whether the lane decides differently from its cpu lane, which rounds every operation as written.
  differs(lane: string) {
    const cpu = this.counterpart(lane, 'cpu'),
      { verdicts } = this.decided;
    return cpu !== undefined && verdicts[lane] !== null && verdicts[cpu] !== null && verdicts[lane] !== verdicts[cpu];
  }
  get vertex() {
    return 3 * Math.floor(this.chosen / 3);
  }
}

// Parses a link's "#p=…&lane=…"; null if it has no pair that this type can hold.
export function from_fragment(type: Scalar, url = location.href): { pair: Coordinates; lane: string } | null {
  const values = new URLSearchParams(new URL(url).hash.slice(1)),
    bits = values.get('p') ?? '',
    of_bits = type_of_bits(bits);
  if (!of_bits || (of_bits === 'f64' && type === 'f32')) return null;
  return { pair: stored_as(type, from_bits(bits, of_bits)), lane: values.get('lane') ?? '' };
}
export const fragment_of = (model: Model) => `#p=${to_bits(model.pair)}&lane=${model.lane}`;
