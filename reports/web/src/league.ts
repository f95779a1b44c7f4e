// SPDX-License-Identifier: Apache-2.0
// The league table: lanes × strata, with false positives and false negatives.
import { breakable, h, marked, paragraph, section } from './dom';
import { bare_percent, count, in_full } from './format';
import { heat_class, heat_legend } from './heat';
import { kept_choice, kept_search } from './kept';
import { lane_picker } from './lane_picker';
import { cell_text, cell_words, type Kind } from './pairs_of_cell';
import type { Report, Share } from './report';
import { matcher } from './search';
import { sortable_table, type Column } from './sortable_table';
import { chosen, go_to, when_chosen } from './state';

type Rate = Report['rates'][number];
type Show = 'both' | Kind;

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
    rate.stored === undefined ? '' : `wrong by storing in float32 ${count(rate.stored)}`,
  ]
    .filter(Boolean)
    .join('; ');
}

export function league_section(report: Report) {
  const rates = new Map(report.rates.map((rate) => [`${rate.lane}/${rate.stratum}`, rate]));
  const find = (lane: number, stratum: number | null) => rates.get(`${lane}/${stratum}`);
  const in_doubles = (stratum: number) => report.strata[stratum].id.endsWith('/f64');
  const places = report.strata.map((_, i) => i);
  const both_types = places.some(in_doubles) && !places.every(in_doubles);
  let show: Show = 'both';

  const readout = h('p', { class: 'readout', 'aria-live': 'polite' });
  const kHint =
    'Point at a cell, or move to it with the arrow keys, to see its counts and intervals. Click it or press Enter to see its pairs.';
  readout.textContent = kHint;

  const part = (share: Share | null, kind: Kind) =>
    share === null || share.of === 0
      ? h('span', { class: 'none' }, '–')
      : h('span', { class: heat_class(share.share), 'data-kind': kind }, bare_percent(share.share));

  // Opens the pairs behind a cell, or shows a message if there are none.
  function press(event: Event, rate: Rate) {
    const pressed = (event.target as Element).closest<HTMLElement>('[data-kind]')?.dataset.kind;
    const kind = (pressed ?? (show === 'both' ? 'wrong' : show)) as Kind;
    const cell = { lane: rate.lane, stratum: rate.stratum, kind };
    if (!rate[kind]?.count) {
      readout.textContent = `${cell_words(report, cell)}: ${rate[kind] ? `none in ${in_full(rate[kind])}` : 'not counted'}, so there is no pair to show.`;
      return;
    }
    go_to('kinds', { cell: cell_text(report, cell) });
  }

  function cell(lane: number, stratum: number | null) {
    const rate = find(lane, stratum);
    if (!rate) return h('td', { class: 'rate' }, '–');
    const title = words(report, rate);
    const tell = () => (readout.textContent = title);
    const enter = (event: KeyboardEvent) => {
      if (event.key === 'Enter') press(event, rate);
    };
    return h(
      'td',
      {
        class: 'rate',
        title,
        onfocus: tell,
        onmouseenter: tell,
        onclick: (event: Event) => press(event, rate),
        onkeydown: enter,
      },
      show === 'both'
        ? [part(rate.false_positive, 'false_positive'), part(rate.false_negative, 'false_negative')]
        : part(rate[show], show),
    );
  }

  function order(lane: number, stratum: number | null) {
    const rate = find(lane, stratum);
    return (show === 'both' ? rate?.wrong : rate?.[show])?.share ?? -1;
  }

  function columns(): Column<number>[] {
    const only = strata.value(),
      type = both_types ? types.value() : 'all';
    const shown = places.filter((i) =>
      only === 'all' ? type === 'all' || in_doubles(i) === (type === 'f64') : report.strata[i].id === only,
    );
    const column = (stratum: number | null, label: string): Column<number> => ({
      label,
      numeric: true,
      cell: (lane) => cell(lane, stratum),
      order: (lane) => order(lane, stratum),
      title: stratum === null ? 'All strata together' : `${label}: ${report.strata[stratum].describes}`,
      heading: [h('span', { class: 'upright' }, label)],
    });
    const all = report.rates.some((rate) => rate.stratum === null) ? [column(null, 'all strata')] : [];
    return [
      { label: 'Lane', cell: (lane) => breakable(report.lanes[lane].id), order: (lane) => lane },
      ...all,
      ...shown.map((stratum) => column(stratum, report.strata[stratum].id)),
    ];
  }

  const table = sortable_table<number>([], {
    caption: 'Share of wrong verdicts in per cent, lanes by strata',
    class: 'league',
    walk: true,
  });
  const update = () => {
    const matches = matcher(chosen('lane'));
    table.show(picker.lanes().filter((lane) => matches([report.lanes[lane].id])));
    readout.textContent = kHint;
  };
  const picker = lane_picker(report, 'league', {}, () => update());

  const redraw = () => {
    show = shows.value() as Show;
    table.columns(columns());
    table.element.classList.toggle('single', show !== 'both');
    update();
  };
  const search = kept_search('lane', 'Find a lane', 'such as moller f64, or */f64/*', update);
  const shows = kept_choice('show', 'Show', kShow, redraw);
  const strata = kept_choice(
    'stratum',
    'Stratum',
    [['all', 'all'], ...report.strata.map(({ id }): [string, string] => [id, id])],
    redraw,
  );
  const types = kept_choice(
    'type',
    'Coordinates',
    [
      ['all', 'float32 and double'],
      ['f32', 'float32'],
      ['f64', 'double'],
    ],
    redraw,
  );
  redraw();
  when_chosen(redraw);
  table.element.classList.add('league-table');
  return section(
    'league',
    'League table',
    paragraph(
      marked(
        'All shares are in per cent. A **false positive** is the verdict “intersects” on triangles that are apart. Its share counts only the pairs that are apart. A **false negative** is the verdict “disjoint” on triangles that meet. Its share counts only the pairs that intersect. Each cell shows false positives above false negatives. Click a column’s heading to sort by that column.',
      ),
    ),
    h('div', { class: 'controls' }, search, shows.element, strata.element, both_types && types.element),
    picker.element,
    h('div', { class: 'between' }, heat_legend(), readout),
    table.element,
  );
}
