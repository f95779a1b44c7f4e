// SPDX-License-Identifier: Apache-2.0
// The differences between two campaigns.
import { breakable, h, list, section, sentence } from './dom';
import { count, in_full, percent } from './format';
import type { Compare, Report, Share } from './report';
import { build_words } from './run';
import { counts, sortable_table, table_of } from './sortable_table';

type Change = Compare['rates'][number];
type Seen = Compare['gained'][number];

type Verdicts = NonNullable<Compare['verdicts']>[number];

const range = (v: Verdicts) => (v.least === v.most ? count(v.most) : `${count(v.least)} to ${count(v.most)}`);
const counted = (number: number | undefined) => (number === undefined ? 'not counted' : count(number));

function verdicts_table(verdicts: Verdicts[]) {
  const changed = verdicts.filter((v) => v.known !== 'same' && v.most > 0);
  if (!changed.length) return h('p', {}, 'Every verdict is the same.');
  return table_of<Verdicts>(
    [
      { label: 'Lane', cell: (v) => breakable(v.lane), order: (v) => v.lane },
      { label: 'Stratum', cell: (v) => v.stratum, order: (v) => v.stratum },
      { label: 'Changed', numeric: true, cell: range, order: (v) => v.most },
      { label: 'Became wrong', numeric: true, cell: (v) => counted(v.broken), order: (v) => v.broken ?? -1 },
      { label: 'No longer wrong', numeric: true, cell: (v) => counted(v.mended), order: (v) => v.mended ?? -1 },
      {
        label: 'Smallest case that became wrong or no longer is',
        cell: (v) => h('code', {}, v.smallest_broken ?? v.smallest_mended ?? ''),
        order: (v) => v.smallest_broken ?? v.smallest_mended ?? '',
      },
    ],
    changed,
    { caption: 'Verdicts that changed', class: 'plain', page: 60 },
  );
}

const cell = (share: Share) => h('td', { class: 'number', title: in_full(share) }, percent(share.share));

const errors_in_full = (change: Change) =>
  change.errors.map((e) => `${e.error}: ${in_full(e.before)} before, ${in_full(e.after)} after`).join('; ');

function rates_table(compare: Compare) {
  const table = sortable_table<Change>(
    [
      { label: 'Lane', cell: (c) => breakable(c.lane), order: (c) => c.lane },
      { label: 'Stratum', cell: (c) => c.stratum, order: (c) => c.stratum },
      { label: 'Before', numeric: true, cell: (c) => cell(c.before), order: (c) => c.before.share },
      { label: 'After', numeric: true, cell: (c) => cell(c.after), order: (c) => c.after.share },
      {
        label: 'Change',
        numeric: true,
        cell: (c) =>
          c.after.share === c.before.share
            ? '0'
            : `${c.after.share > c.before.share ? '+' : '−'}${percent(Math.abs(c.after.share - c.before.share)).replace('%', 'points')}`,
        order: (c) => c.after.share - c.before.share,
      },
      {
        label: 'Changed',
        title: 'Yes if the change is larger than chance explains, or, on the same pairs, if any count differs',
        cell: (c) =>
          c.changed ? h('b', { title: errors_in_full(c) }, c.errors.map((e) => e.error).join(', ') || 'yes') : 'no',
        order: (c) => Number(c.changed),
        descending_first: true,
      },
    ],
    { caption: 'Share wrong before and after', class: 'plain', page: 60 },
  );
  const all = h('input', { type: 'checkbox', onchange: () => update() });
  const update = () => table.show(all.checked ? compare.rates : compare.rates.filter((c) => c.changed));
  update();
  return [
    h(
      'label',
      { class: 'check' },
      all,
      ` show the ${count(compare.rates.filter((c) => !c.changed).length)} unchanged rates too`,
    ),
    table.element,
  ];
}

function kinds_table(caption: string, seen: Seen[]) {
  if (!seen.length) return h('div', {}, h('h3', {}, `${caption}: none`));
  const table = table_of<Seen>(
    [
      { label: 'Kind', cell: (s) => h('code', {}, ...breakable(s.key)), order: (s) => s.key },
      counts('Signatures', (s) => s.signatures),
      counts('Pairs', (s) => s.count),
    ],
    seen,
    { caption, class: 'plain', page: 30 },
  );
  return h('div', {}, h('h3', {}, `${caption}: ${count(seen.length)}`), table);
}

export function compare_section(report: Report) {
  const { compare } = report;
  if (!compare) return null;
  const side = (name: string, run: Report['run']) =>
    h(
      'div',
      {},
      h('dt', {}, name),
      h('dd', {}, `${count(run.pairs)} pairs, seed ${run.seed}; ${build_words(run).join(', ')}`),
    );
  return section(
    'compare',
    'Comparison',
    h('p', { class: 'headline' }, h('b', {}, compare.headline)),
    compare.differences.length > 0 && list(compare.differences.map(sentence), { class: 'differences' }),
    h('dl', { class: 'facts both' }, side('Before', compare.other), side('After', report.run)),
    compare.verdicts ? [h('h3', {}, 'Verdicts'), verdicts_table(compare.verdicts)] : null,
    h('h3', {}, 'Rates'),
    rates_table(compare),
    compare.kinds_compared &&
      h(
        'div',
        { class: 'two' },
        kinds_table('Kinds of failure gained', compare.gained),
        kinds_table('Kinds of failure lost', compare.lost),
      ),
  );
}
