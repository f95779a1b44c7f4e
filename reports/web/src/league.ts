// SPDX-License-Identifier: Apache-2.0
// The league table: lanes × strata, with false positives and false negatives.
import { breakable, choice, h, section } from './dom';
import { bare_percent, count, in_full } from './format';
import { heat_class, heat_legend } from './heat';
import { lane_picker } from './lane_picker';
import { cell_text, cell_words, kErrors, type Kind } from './pairs_of_cell';
import type { Report, Share } from './report';
import { matcher } from './search';
import { sortable_table, type Column } from './sortable_table';
import { choose, chosen, go_to, when_chosen } from './state';

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
  let show: Show = 'both',
    only = 'all',
    type = 'all';

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
    const shown =
      only !== 'all' ? [Number(only)] : places.filter((i) => type === 'all' || in_doubles(i) === (type === 'f64'));
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

  const table = sortable_table<number>(columns(), {
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

  const search = h('input', {
    type: 'search',
    placeholder: 'such as moller f64, or */f64/*',
    oninput: () => {
      choose('lane', search.value.trim());
      update();
    },
  });
  const shows = choice('Show', kShow, show, (value) => {
    choose('show', value === 'both' ? '' : value);
    redraw();
  });
  const strata = choice(
    'Stratum',
    [['all', 'all'], ...report.strata.map((stratum, i): [string, string] => [String(i), stratum.id])],
    only,
    (value) => {
      choose('stratum', value === 'all' ? '' : report.strata[Number(value)].id);
      redraw();
    },
  );
  const types = choice(
    'Coordinates',
    [
      ['all', 'float32 and double'],
      ['f32', 'float32'],
      ['f64', 'double'],
    ],
    type,
    (value) => {
      choose('type', value === 'all' ? '' : value);
      redraw();
    },
  );
  const redraw = () => {
    type = both_types && ['f32', 'f64'].includes(chosen('type')) ? chosen('type') : 'all';
    types.querySelector('select')!.value = type;
    const place = report.strata.findIndex((stratum) => stratum.id === chosen('stratum'));
    only = place < 0 ? 'all' : String(place);
    show = chosen('show') in kErrors ? (chosen('show') as Kind) : 'both';
    shows.querySelector('select')!.value = show;
    strata.querySelector('select')!.value = only;
    search.value = chosen('lane');
    table.columns(columns());
    table.element.classList.toggle('single', show !== 'both');
    update();
  };
  redraw();
  when_chosen(redraw);
  table.element.classList.add('league-table');
  return section(
    'league',
    'League table',
    h(
      'p',
      {},
      'All shares are in per cent. A ',
      h('b', {}, 'false positive'),
      ' is the verdict “intersects” on triangles that are apart. Its share is that among the pairs that are apart. A ',
      h('b', {}, 'false negative'),
      ' is the verdict “disjoint” on triangles that meet. Its share is that among the pairs that intersect. Each cell shows false positives above false negatives. Click a column’s heading to sort by that column.',
    ),
    h(
      'div',
      { class: 'controls' },
      h('label', { class: 'field' }, h('span', {}, 'Find a lane'), search),
      shows,
      strata,
      ...(both_types ? [types] : []),
    ),
    picker.element,
    h('div', { class: 'between' }, heat_legend(), readout),
    table.element,
  );
}
