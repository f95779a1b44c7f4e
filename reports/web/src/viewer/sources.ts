// SPDX-License-Identifier: Apache-2.0
// Sources of pairs: the file from which the page was made, the special cases of 2012, or a stratum.
import { button, choice, h } from '../dom';
import { from_bits, type Coordinates, type ViewData } from './data';
import { special_cases, type Model } from './model';

const kSearched = 200_000; // the largest number of a stratum's pairs in one search
const kSearchSlice = 30; // milliseconds between progress updates

export type Wanted = 'any' | 'apart' | 'wrong';

export function sources(model: Model, data: ViewData, say: (text: string) => void) {
  const { graze } = model,
    given = data.pairs.map(({ name, bits }) => ({ name, pair: from_bits(bits, data.coordinates) }));
  const lists: Record<string, { name: string; pair: Coordinates }[]> = {
    given,
    special: special_cases(graze.coordinates),
  };
  const named = /^([a-z_]+(?:\/f64)?):(\d+):(\d+)$/.exec(data.pairs[0]?.name ?? ''),
    of_stratum = named && given.length === 1 && graze.strata.includes(named[1]) ? named : null;
  let source = of_stratum ? of_stratum[1] : given.length ? 'given' : 'special',
    seed = BigInt(of_stratum?.[2] ?? 1),
    at = Number(of_stratum?.[3] ?? 0),
    searching = 0;

  // Lets Next and Previous continue from this pair, if it is one of the given pairs.
  function find(pair: Coordinates) {
    const found = given.findIndex((one) => one.pair.every((x, c) => Object.is(x, pair[c])));
    if (found < 0 || of_stratum) return;
    source = 'given';
    at = found;
    select.querySelector('select')!.value = source;
  }

  const length = () => lists[source]?.length ?? Infinity;
  const pair_at = (i: number) =>
    lists[source]?.[i] ?? { name: `${source}:${seed}:${i}`, pair: graze.generate(source, seed, BigInt(i)) };
  const place = h('span', { class: 'small', id: 'place' });

  function show(i: number) {
    at = i;
    const { name, pair } = pair_at(at);
    model.show(pair, name);
    model.choose_telling();
  }

  // Whether some lane is wrong on the pair or, for `apart`, whether some GPU lane differs from the CPU's.
  function fits(wanted: Wanted, pair: Coordinates) {
    const verdicts = graze.decide(pair);
    if (wanted === 'wrong') {
      const { verdict } = graze.truth(pair);
      return verdict !== 'declined' && Object.values(verdicts).some((said) => said !== null && said !== verdict);
    }
    return graze.lanes.some(
      (lane) => lane.endsWith('/cuda-fma') && verdicts[lane] !== verdicts[lane.replace('cuda-fma', 'cpu')],
    );
  }

  async function go(by: 1 | -1, wanted: Wanted = 'any') {
    const search = ++searching;
    let pause = performance.now();
    for (let tried = 0, i = at + by; tried < kSearched; ++tried, i += by) {
      if (lists[source]) {
        if (tried >= length()) break;
        i = (i + length()) % length();
      } else if (i < 0) break;
      if (wanted === 'any' || fits(wanted, pair_at(i).pair)) {
        return show(i);
      }
      if (performance.now() - pause > kSearchSlice) {
        place.textContent = `searching, ${i} …`;
        await new Promise((resolve) => setTimeout(resolve, 0));
        if (search !== searching) return;
        pause = performance.now();
      }
    }
    update();
    say(
      `no such pair among these ${Math.min(kSearched, length()).toLocaleString('en-US')}; choose a stratum at "Pairs of", such as thesis or near_edge_edge`,
    );
  }

  const options = [
    ...(given.length && !of_stratum ? [['given', data.title]] : []),
    ['special', 'special cases of 2012'],
    ...graze.strata.map((id) => [id, `stratum ${id}`]),
  ] as [string, string][];
  const select = choice('Pairs of', options, source, (value) => {
    source = value;
    seed = 1n;
    show(0);
  });
  function update() {
    place.textContent = Number.isFinite(length()) ? `${at + 1} of ${length()}` : `index ${at}, seed ${seed}`;
  }
  return {
    go,
    update,
    find,
    element: h(
      'div',
      { class: 'controls sources' },
      select,
      h(
        'div',
        { class: 'chips' },
        button('Previous', () => go(-1)),
        button('Next', () => go(1)),
        button('Next where CPU and GPU differ', () => go(1, 'apart')),
        button('Next with a wrong verdict', () => go(1, 'wrong')),
        place,
      ),
    ),
  };
}
