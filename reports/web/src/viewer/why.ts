// SPDX-License-Identifier: Apache-2.0
// Why the chosen lane says what it says: where its run parts from that of the CPU, or from numbers of 113 bits.
import { h, type Child } from '../dom';
import { figure } from '../format';
import type { Step } from './graze.js';
import type { Model } from './model';

const code = (text: string) => h('code', {}, text);
const number = (x: number) => (Object.is(x, -0) ? '-0' : x === 0 || !Number.isFinite(x) || (Number.isInteger(x) && Math.abs(x) < 1e6) ? String(x) : figure(x));
// Numbers that differ are shown with as many digits as it takes to see that.
function both(left: number, right: number): [string, string] {
  for (let digits = 4; left !== right && number(left) === number(right) && digits <= 17; ++digits) {
    const longer = [left, right].map((x) => String(Number(x.toPrecision(digits))));
    if (longer[0] !== longer[1]) return [longer[0], longer[1]];
  }
  return [number(left), number(right)];
}
function compared(step: Step, exact = false) {
  const [left, right] = exact ? both(step.exactLeft, step.exactRight) : both(step.left, step.right);
  return step.relation ? `${left} ${step.relation} ${right}` : left;
}
const kMostPlaces = 2;
const outcome = (held: boolean) => (held ? 'yes' : 'no');

// The first comparison that two runs of one algorithm decide differently; up to it they are the same comparisons.
function parting(run: Step[], other: Step[]): [Step, Step] | null {
  const [mine, theirs] = [run, other].map((steps) => steps.filter((step) => step.relation));
  const at = mine.findIndex((step, i) => i < theirs.length && step.held !== theirs[i].held);
  return at < 0 ? null : [mine[at], theirs[at]];
}

function beside_the_cpu(model: Model, run: Step[], cpu: string): Child[] {
  const { lane, graze, pair } = model, other = graze.steps(pair, cpu), found = other && parting(run, other.steps);
  const sites = graze.contractions(pair, lane);
  const parts: Child[] = [];
  if (found) {
    const [mine, theirs] = found;
    parts.push('CPU and GPU run the same source, and part at ', code(mine.line), ': there the CPU computes ', code(compared(theirs)), ` (${outcome(theirs.held)}), the GPU `, code(compared(mine)), ` (${outcome(mine.held)})`,
      '; with 113 bits it is ', code(compared(mine, true)), ` (${outcome(mine.holds)}). `);
  }
  if (sites.length) {
    const places = [...new Map(sites.map((site) => [`${site.line} ${site.from}`, site])).values()];
    parts.push('The cause is ', h('strong', {}, 'contraction'), ': for the GPU, nvcc fuses ', code('a * b + c'), ' into one operation with one rounding at ',
      places.slice(0, kMostPlaces).map(({ line, from }, i) => [i ? ' and ' : '', code(line), from ? [' called at ', code(from)] : '']), places.length > kMostPlaces && `, and at ${places.length - kMostPlaces} more`, ', where the CPU rounds twice. Fused there alone, the verdict is already the GPU’s.');
  }
  return parts;
}

function beside_exact(run: Step[]): Child[] {
  const wrong = run.find((step) => step.relation && step.held !== step.holds);
  if (!wrong) return ['Every comparison goes as it does with 113 bits: the ', h('strong', {}, 'logic'), ' of the algorithm is wrong here, not rounding.'];
  const numbers = [wrong.left, wrong.right, wrong.exactLeft, wrong.exactRight];
  const lost = numbers.slice(0, 2).some((x) => !Number.isFinite(x)) ? 'the numbers left their range, by overflow or underflow'
    : numbers.slice(0, 2).every((x) => x === 0) && numbers.slice(2).some((x) => x !== 0) ? 'lost to zero, by underflow or in a difference' : 'rounding';
  return ['The first comparison that goes wrong is at ', code(wrong.line), ': the lane computes ', code(compared(wrong)), ` (${outcome(wrong.held)}), with 113 bits it is `,
    code(compared(wrong, true)), ` (${outcome(wrong.holds)}): `, h('strong', {}, lost), '. ', code('graze explain'), ' says which comparison decides.'];
}

function steps_table(run: Step[]) {
  return h('details', {}, h('summary', {}, `All ${run.length} steps`),
    h('div', { class: 'scroller', tabindex: 0, role: 'group', 'aria-label': 'Steps' }, h('table', { class: 'plain steps' },
      h('thead', {}, h('tr', {}, ['source line', 'what', 'in the lane', 'with 113 bits'].map((title) => h('th', { scope: 'col' }, title)))),
      h('tbody', {}, run.map((step) => h('tr', { class: step.relation && step.held !== step.holds ? 'bad' : '' },
        h('td', {}, code(step.line)), h('td', {}, step.site.replace('_', ' ') || 'comparison'),
        [false, true].map((exact) => h('td', {}, code(compared(step, exact)), step.relation ? ` ${outcome(exact ? step.holds : step.held)}` : ''))))))));
}

export function why(model: Model) {
  const text = h('p', { class: 'because' }), more = h('div', {}), title = h('h2', { id: 'why-title' });

  function update() {
    const { lane, graze, pair, decided, policy } = model, verdict = decided.verdicts[lane], cpu = model.counterpart(lane, 'cpu');
    const right = model.wrong(lane) ? 'wrong' : 'right';
    title.replaceChildren('Why does ', code(lane), ` say ${verdict ?? 'nothing'}?`);
    const known = graze.steps(pair, lane), run = known?.steps;
    const parts: Child[] = [];
    if (verdict === null) parts.push('This lane has no such policy.');
    else if (decided.truth.verdict === 'declined') parts.push('A coordinate is not finite.');
    else if (!run) parts.push(lane.startsWith('exact/') ? 'It is the exact decision: integers of as many bits as it takes.' : 'Its steps are not known.');
    else {
      const plain = policy ? 'Without the policy: ' : '';
      if (!policy) parts.push(h('strong', { class: right === 'wrong' ? 'bad' : '' }, `It is ${right}. `));
      const apart = !policy && model.differs(lane) && cpu ? beside_the_cpu(model, run, cpu) : [];
      parts.push(plain, apart.length ? apart : right === 'wrong' && !policy ? beside_exact(run) : `Its ${run.filter((step) => step.relation).length} comparisons ${run.some((step) => step.relation && step.held !== step.holds) ? 'do not all go as they do with 113 bits, but the verdict stands.' : 'go as they do with 113 bits.'}`);
    }
    if (known && !known.own) parts.push(' (The numbers are those of a rule of contraction that gives the lane’s verdict; they may not be the lane’s own.)');
    text.replaceChildren(h('span', {}, parts));
    const open = more.querySelector('details')?.open ?? false;
    more.replaceChildren(...(run ? [steps_table(run)] : []));
    if (open) more.querySelector('details')!.open = true;
  }
  return { element: h('section', { id: 'why', 'aria-labelledby': 'why-title' }, title, text, more), update };
}
