// SPDX-License-Identifier: Apache-2.0
// The live verdicts of all lanes; changed verdicts are marked and announced.
import { breakable, button, h, scroller, table, table_row, type Child } from '../dom';
import type { Model } from './model';

const kMostSaid = 3;

export function matrix(model: Model) {
  const rows = new Map<string, string[]>(),
    variants: string[] = [];
  for (const lane of model.graze.lanes) {
    const [subject, scalar, variant] = lane.split('/'),
      column = variant === 'cuda' ? 'cuda-fma' : variant;
    rows.set(`${subject}/${scalar}`, [...(rows.get(`${subject}/${scalar}`) ?? []), lane]);
    if (!variants.includes(column)) variants.push(column);
  }
  const cells = new Map(
    model.graze.lanes.map((lane) => [lane, button('', () => model.set({ lane }), { 'data-lane': lane })]),
  );
  const told = h('p', { class: 'announced', 'aria-live': 'polite', id: 'flips' });
  const cell = (lanes: string[], variant: string) =>
    lanes.find((lane) => lane.endsWith(`/${variant}`) || (variant === 'cuda-fma' && lane.endsWith('/cuda')));
  const titles: Record<string, Child> = {
    cpu: 'CPU',
    'cuda-nofma': ['GPU, ', h('span', { class: 'whole' }, '-fmad=false')],
    'cuda-fma': 'GPU, nvcc’s default',
  };
  const drawn_rows = [...rows].map(([name, lanes]) => ({
    lanes,
    element: table_row(
      breakable(name),
      variants.map((variant) => {
        const lane = cell(lanes, variant);
        return h('td', {}, lane ? cells.get(lane)! : h('span', { class: 'none' }, '–'));
      }),
    ),
  }));
  const element = scroller(
    'Verdicts',
    table(
      'plain lanes',
      'Verdicts of all lanes',
      ['', ...variants.map((variant) => [titles[variant] ?? variant, h('code', {}, variant)])],
      drawn_rows.map((row) => row.element),
    ),
  );
  let before: typeof model.decided.verdicts | null = null;

  function update() {
    const { verdicts } = model.decided,
      flipped: string[] = [];
    for (const [lane, button] of cells) {
      const verdict = verdicts[lane],
        wrong = model.wrong(lane),
        differs = model.differs(lane);
      const text = verdict === null ? '–' : `${wrong ? '✗ ' : ''}${verdict}${differs ? ' ≠' : ''}`;
      const flips = before !== null && before[lane] !== verdict;
      if (button.textContent !== text) button.textContent = text;
      button.className = `${wrong ? 'bad' : ''}${differs ? ' differs' : ''}`;
      if (flips) {
        flipped.push(
          `${lane} ${verdict === null ? 'has no such policy' : `now says ${verdict}${wrong ? ', wrong' : ''}`}`,
        );
        button.getAnimations().forEach((old) => old.cancel());
        if (!matchMedia('(prefers-reduced-motion: reduce)').matches)
          button.animate([{ background: 'var(--flip)' }, {}], { duration: 900 });
      }
      button.setAttribute(
        'aria-label',
        `${lane}: ${verdict ?? 'no such policy'}${wrong ? ', wrong' : ''}${differs ? ', differs from the CPU' : ''}`,
      );
      button.setAttribute('aria-pressed', String(lane === model.lane));
    }
    for (const row of drawn_rows)
      row.element.classList.toggle(
        'apart',
        row.lanes.some((lane) => model.differs(lane)),
      );
    before = verdicts;
    if (flipped.length)
      told.textContent = `${flipped.slice(0, kMostSaid).join('; ')}${flipped.length > kMostSaid ? `; and ${flipped.length - kMostSaid} more` : ''}.`;
  }
  const key = h(
    'p',
    { class: 'small' },
    h('b', { class: 'bad' }, '✗'),
    ' wrong, ',
    h('u', {}, '≠'),
    ' differs from the CPU. Press a verdict to learn why.',
  );
  const asked = h(
    'p',
    { class: 'small' },
    'The verdict of each lane. A lane is an algorithm in float32 (f32) or float64 (f64), built for CPU or GPU.',
  );
  return { element: h('div', { class: 'verdicts-of-all' }, asked, element, key), told, update };
}
