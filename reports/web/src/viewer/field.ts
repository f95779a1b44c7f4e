// SPDX-License-Identifier: Apache-2.0
// Many triangles against the reference, as in 2012: random triangles from the thesis's generator, its special cases, or
// the triangles of a mesh or a query.
import { button, h } from '../dom';
import { count, counted } from '../format';
import { from_bits, type Coordinates, type ViewData } from './data';
import { special_cases, without_changed, type Model } from './model';
import type { Field } from './shape';

const kFirst = 10, // as in 2012
  kMost = 5000;

type Kind = 'given' | 'random' | 'special';

export function field(model: Model, data: ViewData, say: (text: string) => void, changed: () => void) {
  const { graze } = model,
    special = special_cases(graze.coordinates),
    thesis = graze.coordinates === 'f64' ? 'thesis/f64' : 'thesis',
    given = data.triangles.map((bits) => from_bits(bits, data.coordinates));
  let kind: Kind | null = null, // null: the pair alone
    seed = 1n,
    own: { name: string; pair: Coordinates }, // the pair whose first triangle is the reference
    triangles: Coordinates[] = [],
    ids: number[] = [],
    current: Field | null = null;
  const shown = { given: given.length, random: data.random || kFirst, special: special.length };
  const left: { kind: Kind | null; name: string; pair: Coordinates }[] = []; // the previous drawings, for "Back"
  const told = h('p', { class: 'small', id: 'field' });

  // Random triangles and special cases have their own reference, so showing another pair removes them.
  const drawn = () => (kind && (kind === 'given' || without_changed(model.name) === own.name) ? kind : null);
  const moved = () => kind !== 'given' && own.pair.subarray(0, 9).some((x, c) => x !== model.pair[c]);

  function title() {
    const now = drawn();
    if (!now) return null;
    const many = counted(shown[now], now === 'random' ? 'random triangle' : 'triangle');
    const of = {
      given: `${data.title}: ${many}`,
      random: `${many} of 2012, seed ${seed}`,
      special: 'the ten special cases of 2012',
    };
    return of[now] + (moved() ? ', reference moved' : '');
  }

  function make() {
    triangles =
      kind === 'given'
        ? given.slice(0, shown.given)
        : kind === 'special'
          ? special.map(({ pair }) => pair.slice(9))
          : Array.from({ length: shown.random }, (_, i) => graze.generate(thesis, seed, BigInt(i)).slice(9));
    ids = triangles.map((_, i) => (kind === 'given' ? (data.ids?.[i] ?? i) : i));
    changed();
  }
  const pair_of = (i: number) =>
    kind === 'special' ? special[i] : { name: `${thesis}:${seed}:${i}`, pair: graze.generate(thesis, seed, BigInt(i)) };

  function begin(next: Kind) {
    left.push({ kind: drawn(), name: model.name, pair: model.pair });
    kind = next;
    if (kind !== 'given') face();
    make();
  }
  // Shows the pair that consists of the reference and the first of these triangles.
  function face() {
    own = pair_of(0);
    model.show(own.pair, own.name);
  }
  function back() {
    const before = left.pop()!;
    kind = before.kind;
    if (kind === 'random') own = pair_of(0);
    model.show(before.pair, before.name);
    if (kind) make();
  }

  // Decides all triangles with the chosen lane and with the exact decision.
  function decide() {
    if (!drawn()) {
      kind = null;
      left.length = 0;
      return (current = null);
    }
    const { exports } = graze,
      lane = graze.lanes.indexOf(model.lane),
      hit: boolean[] = [],
      wrong: boolean[] = [];
    for (let first = 0; first < triangles.length; first += graze.room) {
      const some = triangles.slice(first, first + graze.room);
      const room = graze.numbers_at(exports.pairs(), 18 * some.length);
      some.forEach((triangle, i) => {
        room.set(model.pair.subarray(0, 9), 18 * i);
        room.set(triangle, 18 * i + 9);
      });
      const said = () => new Uint8Array(exports.memory.buffer, exports.verdicts(), some.length).slice();
      exports.decide_truth(some.length);
      const truth = said();
      const verdicts = exports.decide(lane, some.length) ? said() : truth;
      verdicts.forEach((verdict, i) => {
        hit.push(verdict === 1);
        wrong.push(verdict !== truth[i]);
      });
    }
    return (current = { title: title()!, of_2012: kind !== 'given', triangles, ids, hit, wrong });
  }

  function tell() {
    const sum = (all: boolean[]) => count(all.filter(Boolean).length);
    told.replaceChildren(
      ...(current
        ? [
            h('strong', {}, `${counted(triangles.length, 'triangle')} against a, the reference: `),
            h('code', {}, model.lane),
            ` hits ${sum(current.hit)}, wrong on ${sum(current.wrong)} (outlined). The table shows one pair, ${model.name}; press a verdict to see its lane here. `,
            ...(current.hit.some(Boolean) || current.wrong.some(Boolean)
              ? [button(current.wrong.some(Boolean) ? 'Take a wrong one' : 'Take a hit', take), ' ']
              : []),
            button(left.at(-1)!.kind ? 'Back to the random triangles' : 'Back to the pair', back),
          ]
        : []),
    );
  }

  function take() {
    const at = current!.wrong.indexOf(true),
      one = at < 0 ? current!.hit.indexOf(true) : at;
    if (one < 0) return;
    const name = kind === 'given' ? model.name : pair_of(one).name,
      unchanged = kind !== 'given' && !moved(),
      pair = model.pair.slice();
    pair.set(triangles[one], 9);
    kind = null;
    model.show(pair, unchanged ? name : `${without_changed(name)}, changed`);
  }

  // The triangles that +, - and space change: those of a mesh or a query if there are any; otherwise random triangles.
  const changing = given.length ? 'given' : 'random';
  const special_stay = () => say('the special cases are fixed; press t to leave them');
  return {
    element: told,
    title,
    current: () => current,
    all: () => begin(changing),
    special: () => (drawn() === 'special' ? back() : begin('special')),
    add(more: 1 | -1) {
      if (drawn() === 'special') return special_stay();
      if (!drawn()) return begin(changing);
      shown[changing] = Math.max(1, Math.min(given.length || kMost, shown[changing] + more));
      make();
    },
    again() {
      if (drawn() === 'special') return special_stay();
      if (!drawn()) return begin(changing);
      if (changing === 'given') return;
      ++seed;
      face();
      make();
    },
    update() {
      decide();
      tell();
    },
  };
}
