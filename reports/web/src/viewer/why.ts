// SPDX-License-Identifier: Apache-2.0
// Explains the chosen lane's verdict: where its run differs from the CPU's, or from a run with 113 bits.
import { h, marked, paragraph, scroller, table, type Child } from '../dom';
import { apart, differing } from './apart';
import type { Graze, Step, Verdict } from './graze.js';
import type { Model } from './model';
import { code, compared, outcome, quoted } from './numbers';

function beside_exact(run: Step[], says: Verdict, with_113_bits: Verdict): Child[] {
  const wrong = run.find((step) => step.relation && step.held !== step.holds);
  if (with_113_bits === says || !wrong)
    return marked(
      `With 113 bits the algorithm says **${with_113_bits}** as well: its **logic** is wrong here, not its rounding.`,
    );
  const numbers = [wrong.left, wrong.right, wrong.exactLeft, wrong.exactRight];
  const lost = numbers.slice(0, 2).some((x) => !Number.isFinite(x))
    ? 'the numbers left their range, by overflow or underflow'
    : numbers.slice(0, 2).every((x) => x === 0) && numbers.slice(2).some((x) => x !== 0)
      ? 'the value became zero, by underflow or in a difference'
      : 'rounding';
  return [
    marked(
      `With numbers of 113 bits (float32 has 24, float64 has 53), the algorithm says **${with_113_bits}**. The first comparison with a different outcome in the lane is at `,
    ),
    quoted(wrong.line),
    marked(
      `The lane computes \`${compared(wrong)}\` (${outcome(wrong.held)}), with 113 bits it is \`${compared(wrong, true)}\` (${outcome(wrong.holds)}): **${lost}**. \`graze explain\` says which comparison decides.`,
    ),
  ];
}

function steps_table(run: Step[]) {
  return h(
    'details',
    {},
    h('summary', {}, `All ${run.length} steps`),
    scroller(
      'Steps',
      table(
        'plain steps',
        null,
        ['source line', 'what', 'in the lane', 'with 113 bits'],
        run.map((step) =>
          h(
            'tr',
            { class: step.relation && step.held !== step.holds ? 'bad' : '' },
            h('td', {}, code(step.line.replace('core/algorithms/', ''))),
            h('td', {}, step.site.replace('_', ' ') || 'comparison'),
            [false, true].map((exact) =>
              h(
                'td',
                {},
                code(compared(step, exact)),
                step.relation ? ` ${outcome(exact ? step.holds : step.held)}` : '',
              ),
            ),
          ),
        ),
      ),
    ),
  );
}

export function why(model: Model) {
  const text = h('div', { class: 'because' }),
    more = h('div', {}),
    title = h('h2', { id: 'why-title' }),
    brief = h('p', { id: 'brief' });

  // Explains a lane without comparing it with its counterpart.
  function alone(known: ReturnType<Graze['steps']>): Child[] {
    const { lane, decided, policy } = model,
      run = known?.steps,
      says = decided.verdicts[lane];
    if (says === null) return ['This lane has no such policy.'];
    if (decided.truth.verdict === 'declined') return ['A coordinate is not finite.'];
    const stored = lane.split('/')[1] === 'f32' ? decided.stored : null,
      of_stored = stored && 'It decides the coordinates as float32 stores them. ';
    if (!run)
      return [
        of_stored,
        lane.startsWith('exact/')
          ? 'It is the exact decision: it computes with integers of as many bits as it takes.'
          : 'Its steps are not known.',
      ];
    const wrong = model.wrong(lane) && !policy;
    return [
      policy
        ? 'Without the policy: '
        : h('strong', { class: wrong ? 'bad' : '' }, `It is ${wrong ? 'wrong' : 'right'}. `),
      of_stored,
      wrong && says === stored?.verdict
        ? marked('For these its verdict is right, so the cause is **rounding of the input**.')
        : wrong
          ? beside_exact(run, says, known!.with_113_bits)
          : `Its ${run.filter((step) => step.relation).length} comparisons ${run.some((step) => step.relation && step.held !== step.holds) ? 'do not all have the same outcome with 113 bits, but that does not change the verdict.' : 'have the same outcome with 113 bits.'}`,
    ];
  }

  function update() {
    const { lane, graze, pair, decided, policy } = model,
      gpu = policy ? undefined : differing(model, lane),
      known = graze.steps(pair, lane);
    const found = gpu ? apart(model, gpu) : null;
    brief.replaceChildren(h('span', {}, found?.brief ?? null));
    title.replaceChildren(
      ...(gpu
        ? ['Why do CPU and GPU differ?']
        : ['Why does ', code(lane), ` say ${decided.verdicts[lane] ?? 'nothing'}?`]),
    );
    text.replaceChildren(
      h(
        'div',
        {},
        found
          ? found.parts
          : paragraph(
              alone(known),
              known &&
                !known.own &&
                ' (The numbers are those of a rule of contraction that gives the lane’s verdict; they may not be the lane’s own.)',
            ),
      ),
    );
    const open = more.querySelector('details')?.open ?? false;
    more.replaceChildren(...(known ? [steps_table(known.steps)] : []));
    if (open) more.querySelector('details')!.open = true;
  }
  return { brief, element: h('section', { id: 'why', 'aria-labelledby': 'why-title' }, title, text, more), update };
}
