// SPDX-License-Identifier: Apache-2.0
// Explains why a GPU lane decides differently from the same source on the CPU: the first comparison with different
// outcomes, the values there, and the operations that nvcc fused.
import { h, marked, paragraph, table, table_row, type Child } from '../dom';
import { figure } from '../format';
import type { Site, Step } from './graze.js';
import type { Model } from './model';
import { outcome, quoted, told_apart, ulp_of } from './numbers';
import { intervals, projections } from './ranges';

const kMostPlaces = 2;
export function show_why() {
  const section = document.getElementById('why')!,
    still = matchMedia('(prefers-reduced-motion: reduce)').matches;
  section.scrollIntoView({ block: 'start', behavior: still ? 'auto' : 'smooth' });
  if (!still) section.animate([{ background: 'var(--flip)' }, {}], { duration: 1200 });
}

// Returns the GPU lane that differs from the CPU lane: `lane` itself, or the counterpart of a CPU lane.
export function differing(model: Model, lane: string): string | undefined {
  return [lane, model.counterpart(lane, 'cuda-fma')].find((one) => one !== undefined && model.differs(one));
}

// The index, in each run, of the first comparison with different outcomes. Up to that comparison, both runs take the
// same steps.
function parting(run: Step[], other: Step[]): [number, number] | null {
  const places = (steps: Step[]) => steps.flatMap((step, i) => (step.relation ? [i] : []));
  const [mine, theirs] = [places(run), places(other)];
  const at = mine.findIndex((place, i) => i < theirs.length && run[place].held !== other[theirs[i]].held);
  return at < 0 ? null : [mine[at], theirs[at]];
}

// Describes the compared quantity, if the values that were passed to the policy identify it.
function meaning(runs: [Step[], number][], scalar: string): Child {
  const [[run, at]] = runs,
    step = run[at];
  if (step.site === 'separation')
    return 'It compares an end of one triangle’s range on a line with an end of the other’s, to see whether they overlap. ';
  const asked = run
    .slice(0, at)
    .filter((before) => !before.relation && before.result >= 0 && before.result === step.result)
    .at(-1)?.site;
  if (asked === 'plane_distance')
    return 'The sign of this value says on which side of the other triangle’s plane a vertex lies. ';
  if (asked === 'orientation')
    return 'The sign of this value says on which side of a line or plane through other vertices a vertex lies. ';
  if (asked === 'parallel')
    return 'It is one component of the direction of the line where the planes meet, which is zero for parallel planes. ';
  if (step.relation !== '>' || step.right !== 0) return false;
  const round = scalar === 'f32' ? Math.fround : (x: number) => x;
  const distances = runs.map(([steps, end]) =>
    steps
      .slice(0, end)
      .filter((before) => !before.relation && before.site === 'plane_distance')
      .map(({ left }) => left),
  );
  for (const [which, [steps, end]] of runs.entries()) {
    const d = distances[which],
      at_zero = steps[end].left === 0;
    for (let i = 0; !at_zero && i < d.length; ++i) {
      const j = d.findIndex((y, k) => k > i && round(d[i] * y) === steps[end].left);
      if (j < 0) continue;
      const [mine, theirs] = distances.map((all) => told_apart([all[i], all[j]]).join(' and '));
      return `The value is the product of two vertices’ distances from the other triangle’s plane. It is more than 0 if both vertices lie on the same side of the plane. The distances are ${theirs} on the CPU, and ${mine} on the GPU. `;
    }
  }
  return false;
}

// Both sides of the comparison: on the CPU, on the GPU, and with 113 bits.
const six = (mine: Step, theirs: Step) =>
  told_apart([theirs.left, mine.left, mine.exactLeft, theirs.right, mine.right, mine.exactRight]);

// The triangles whose ranges' ends the step compares; null if it compares something else.
function ends_of(run: Step[], { site, relation, left, right }: Step): [string, string] | null {
  if (site !== 'separation' || relation !== '<') return null;
  const line = intervals(run);
  for (const { a, b } of [...(line ? [line] : []), ...projections(run, '')]) {
    if (a[1] === left && b[0] === right) return ['a', 'b'];
    if (b[1] === left && a[0] === right) return ['b', 'a'];
  }
  return ['one range', 'the other'];
}

function parting_table(
  model: Model,
  run: Step[],
  [mine, theirs]: [Step, Step],
  last: [boolean, boolean],
  verdicts: [string, string],
) {
  const texts = six(mine, theirs);
  const sign = [theirs, mine].every(({ right, exactRight }) => right === 0 && exactRight === 0),
    right = model.decided.truth.verdict;
  const ends = ends_of(run, mine);
  const [one, other, asked] = sign
    ? ['value', '', `${mine.relation} 0?`]
    : ends
      ? [`${ends[0]} ends at`, `${ends[1]} begins at`, 'apart there?']
      : ['left', 'right', `left ${mine.relation} right?`];
  const so = (is_last: boolean, verdict: string) => [
    is_last ? 'says ' : 'continues, then says ',
    h('b', { class: verdict === right ? '' : 'bad' }, `${verdict === right ? '' : '✗ '}${verdict}`),
  ];
  const row = (name: string, i: number, held: boolean, then: Child) =>
    table_row(
      name,
      h('td', {}, h('code', {}, texts[i])),
      !sign && h('td', {}, h('code', {}, texts[i + 3])),
      h('td', {}, outcome(held)),
      h('td', {}, then),
    );
  return table(
    'plain parting',
    null,
    ['', ...[one, other, asked, 'result'].filter(Boolean)],
    [
      row('CPU', 0, theirs.held, so(last[1], verdicts[1])),
      row('GPU', 1, mine.held, so(last[0], verdicts[0])),
      row('with 113 bits', 2, mine.holds, `as the ${mine.holds === theirs.held ? 'CPU' : 'GPU'}`),
    ],
  );
}

function places(sites: Site[]): Child {
  const all = [...new Map(sites.map((site) => [`${site.line} ${site.from}`, site])).values()];
  return paragraph(
    `Fusing only ${all.length > 1 ? 'at these places' : 'here'} already gives the GPU’s verdict: `,
    all
      .slice(0, kMostPlaces)
      .map(({ line, from }, i) => [
        i ? ' and ' : '',
        quoted(line),
        from.startsWith('core/') ? [' called at ', quoted(from)] : '',
      ]),
    all.length > kMostPlaces && ` and at ${all.length - kMostPlaces} more. `,
  );
}

// brief: one line with the values that the two runs compare where they first differ.
export function apart(model: Model, lane: string): { parts: Child[]; brief: Child } {
  const { graze, pair, decided } = model,
    [subject, scalar] = lane.split('/'),
    cpu = model.counterpart(lane, 'cpu')!;
  const known = graze.steps(pair, lane),
    other = graze.steps(pair, cpu),
    found = known && other && parting(known.steps, other.steps),
    sites = graze.contractions(pair, lane);
  const [here, there] = [decided.verdicts[lane]!, decided.verdicts[cpu]!],
    judged = (verdict: string) => (verdict === decided.truth.verdict ? 'right' : 'wrong');
  const says = `**${subject}** in ${scalar === 'f32' ? 'float32' : 'float64'} says **${there}** on the CPU (${judged(there)}) and **${here}** on the GPU (${judged(here)}). `,
    cause = sites.length
      ? `The cause is **contraction**: for the GPU nvcc fuses a multiplication and the following addition, \`a * b + c\`, into one operation that rounds once; the CPU rounds twice, after each of them. So the last digits differ, and here they decide. Built with \`-fmad=false\`, the GPU says ${decided.verdicts[lane.replace('cuda-fma', 'cuda-nofma')]}.`
      : 'Which operation makes the difference is **not settled**.';
  const parts: Child[] = [paragraph(marked(says + cause))];
  let brief: Child = null;
  if (found) {
    const [mine, theirs] = [known.steps[found[0]], other.steps[found[1]]],
      last = (steps: Step[], at: number) => !steps.slice(at + 1).some((step) => step.relation);
    parts.push(
      paragraph(
        'Both run the same source on the same numbers. The first comparison with a different outcome is at ',
        quoted(mine.line),
      ),
      parting_table(
        model,
        known.steps,
        [mine, theirs],
        [last(known.steps, found[0]), last(other.steps, found[1])],
        [here, there],
      ),
    );
    const [x, y, , z, w] = six(mine, theirs),
      whose = ends_of(known.steps, mine),
      step = ulp_of(scalar)(Math.max(Math.abs(mine.left), Math.abs(mine.right)));
    brief = [
      marked(
        `\`${subject}\` in ${scalar} asks${whose ? ` whether ${whose[0]} ends before ${whose[1]} begins` : ''}: on the CPU \`${x} ${mine.relation} ${z}\`, ${outcome(theirs.held)}; on the GPU \`${y} ${mine.relation} ${w}\`, ${outcome(mine.held)}. `,
      ),
      h(
        'a',
        {
          href: '#why',
          onclick: (event: Event) => {
            event.preventDefault();
            show_why();
          },
        },
        'Why?',
      ),
    ];
    const [long, bits] = scalar === 'f32' ? ['float32', 24] : ['float64', 53];
    parts.push(
      paragraph(
        h(
          'span',
          { class: 'small' },
          `113 bits: the same algorithm with numbers of 113 bits; ${long} has ${bits}.${Number.isFinite(step) && mine.right !== 0 ? ` Neighbouring numbers of ${long} are ${figure(step)} apart at this size.` : ''}`,
        ),
      ),
    );
    const asked = meaning(
      [
        [known.steps, found[0]],
        [other.steps, found[1]],
      ],
      scalar,
    );
    const noise =
      mine.right === 0 &&
      mine.exactRight === 0 &&
      mine.exactLeft === 0 &&
      'With 113 bits the value is 0: any other value there is a rounding error, and its sign decides.';
    if (asked || noise) parts.push(paragraph(asked, noise));
    if (!known.own)
      parts.push(
        paragraph(
          marked(
            'The GPU’s numbers here are **not settled**: they come from a rule of contraction that gives the lane’s verdict.',
          ),
        ),
      );
  } else {
    parts.push(paragraph(marked('Which comparison is the first with different outcomes is **not settled**.')));
  }
  if (sites.length) parts.push(places(sites));
  return { parts, brief };
}
