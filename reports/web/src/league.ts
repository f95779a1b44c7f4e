// SPDX-License-Identifier: Apache-2.0
// The league table: lanes × strata, with false positives and false negatives.
import { breakable, choice, h, section } from './dom';
import { bare_percent, in_full } from './format';
import { heat_class, heat_legend } from './heat';
import { lane_picker } from './lane_picker';
import type { Report, Share } from './report';
import { sortable_table, type Column } from './sortable_table';

type Rate = Report['rates'][number];
type Show = 'both' | 'false_positive' | 'false_negative' | 'wrong' | 'differs_from_cpu';

const kShow: [Show, string][] = [
  ['both', 'false positives over false negatives'],
  ['wrong', 'wrong either way'],
  ['false_positive', 'false positives'],
  ['false_negative', 'false negatives'],
  ['differs_from_cpu', 'differs from the cpu lane'],
];

function words(report: Report, rate: Rate): string {
  const { id } = report.lanes[rate.lane];
  const where = rate.stratum === null ? 'all strata' : report.strata[rate.stratum].id;
  return [
    `${id} on ${where}`,
    `false positives ${in_full(rate.false_positive)}`,
    `false negatives ${in_full(rate.false_negative)}`,
    rate.declined ? `declined ${rate.declined}` : '',
    rate.differs_from_cpu ? `differs from cpu ${in_full(rate.differs_from_cpu)}` : '',
  ].filter(Boolean).join('; ');
}

export function league_section(report: Report) {
  const rates = new Map(report.rates.map((rate) => [`${rate.lane}/${rate.stratum}`, rate]));
  const find = (lane: number, stratum: number | null) => rates.get(`${lane}/${stratum}`);
  let show: Show = 'both', only = 'all', text = '';

  const readout = h('p', { class: 'readout', 'aria-live': 'polite' });
  const kHint = 'Point at a cell, or walk through them with the arrow keys, for counts and intervals.';
  readout.textContent = kHint;

  const part = (share: Share | null, sign: string) =>
    share === null || share.of === 0 ? h('span', { class: 'none' }, '–')
      : h('span', { class: heat_class(share.share), 'data-sign': sign }, bare_percent(share.share));

  function cell(lane: number, stratum: number | null) {
    const rate = find(lane, stratum);
    if (!rate) return h('td', { class: 'rate' }, '–');
    const title = words(report, rate);
    const tell = () => (readout.textContent = title);
    return h('td', { class: 'rate', title, onfocus: tell, onmouseenter: tell },
      show === 'both' ? [part(rate.false_positive, '+'), part(rate.false_negative, '−')] : part(rate[show], ''));
  }

  function order(lane: number, stratum: number | null) {
    const rate = find(lane, stratum);
    return (show === 'both' ? rate?.wrong : rate?.[show])?.share ?? -1;
  }

  function columns(): Column<number>[] {
    const shown = only === 'all' ? report.strata.map((_, i) => i) : [Number(only)];
    const column = (stratum: number | null, label: string): Column<number> => ({
      label, numeric: true, cell: (lane) => cell(lane, stratum), order: (lane) => order(lane, stratum),
      title: stratum === null ? 'All strata together' : `${label}: ${report.strata[stratum].describes}`,
      heading: [h('span', { class: 'upright' }, label)],
    });
    const all = report.rates.some((rate) => rate.stratum === null) ? [column(null, 'all strata')] : [];
    return [
      { label: 'Lane', cell: (lane) => breakable(report.lanes[lane].id), order: (lane) => lane },
      ...all, ...shown.map((stratum) => column(stratum, report.strata[stratum].id)),
    ];
  }

  const table = sortable_table<number>(columns(), { caption: 'Share of wrong verdicts in per cent, lanes by strata', class: 'league', walk: true });
  const update = () => {
    table.show(picker.lanes().filter((lane) => report.lanes[lane].id.includes(text)));
    readout.textContent = kHint;
  };
  const picker = lane_picker(report, {}, update);
  update();

  const search = h('input', { type: 'search', placeholder: 'such as moller or f64/cuda', oninput: () => {
    text = search.value.trim().toLowerCase();
    update();
  } });
  const strata = report.strata.map((stratum, i): [string, string] => [String(i), stratum.id]);
  const redraw = () => {
    table.columns(columns());
    table.element.classList.toggle('single', show !== 'both');
  };
  return section('league', 'League table',
    h('p', {}, 'In per cent. A ', h('b', {}, 'false positive'), ' says “intersects” of triangles that are apart, and is counted against the pairs that are apart; a ',
      h('b', {}, 'false negative'), ' misses a contact, and is counted against the pairs that intersect. In each cell false positives stand above false negatives; every head sorts.'),
    h('div', { class: 'controls' },
      h('label', { class: 'field' }, h('span', {}, 'Find a lane'), search),
      choice('Show', kShow, show, (value) => { show = value as Show; redraw(); }),
      choice('Stratum', [['all', 'all'], ...strata], only, (value) => { only = value; redraw(); })),
    picker.element, h('div', { class: 'between' }, heat_legend(), readout), table.element);
}
