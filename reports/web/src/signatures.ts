// SPDX-License-Identifier: Apache-2.0
// Signatures: a table of all that are listed, and a card for each of the commonest.
import { card_element, hulls, kind_id, margin_words, signature_words } from './card';
import { choice, code_block, h, section } from './dom';
import { count, percent } from './format';
import { campaign_command, cell_of, cell_words, kept_pairs, repro_command, wrong_lanes, type Cell } from './pairs_of_cell';
import type { Report } from './report';
import { matcher } from './search';
import { sortable_table } from './sortable_table';
import { choose, chosen, go_to, when_chosen } from './state';

type Signature = Report['signatures'][number];

const kOpenAtFirst = 2;

// "-2^-3" before "0" before "2^4", by size.
function margin_order(margin: string) {
  const found = /^([-+]?)2\^(-?\d+)$/.exec(margin);
  return found ? (found[1] === '-' ? -1 : 1) * (Number(found[2]) + 200) : 0;
}

export function signatures_section(report: Report) {
  const lanes_of = (algorithm: string) => report.lanes.filter((lane) => lane.algorithm === algorithm);
  const cards = report.cards.map((card, i) => card_element(report, card, i));
  cards.slice(0, kOpenAtFirst).forEach(({ open }) => open());

  function marks({ algorithm, marks: text }: Signature) {
    const lanes = lanes_of(algorithm);
    const f64 = lanes.findIndex((lane) => lane.scalar === 'f64');
    return h('span', { class: 'marks' }, [...text].map((mark, i) =>
      h('span', { class: `${{ '+': 'plus', '-': 'minus' }[mark] ?? ''} ${i === f64 ? 'apart' : ''}`, title: `${lanes[i]?.id}: ${{ '+': 'false positive', '-': 'false negative', '?': 'declined', '.': 'right' }[mark] ?? 'did not run'}` }, mark === '-' ? '−' : mark)));
  }

  function open_card(place: number) {
    cards[place].details.hidden = false;
    cards[place].open();
    cards[place].details.querySelector('summary')?.focus({ preventScroll: true });
  }

  const table = sortable_table<Signature>([
    { label: 'No.', numeric: true, cell: (s) => String(report.signatures.indexOf(s) + 1), order: (s) => -s.count },
    { label: 'Pairs', numeric: true, cell: (s) => count(s.count), order: (s) => s.count },
    { label: 'Share', numeric: true, cell: (s) => percent(s.share), order: (s) => s.share },
    { label: 'Algorithm', cell: (s) => s.algorithm, order: (s) => s.algorithm },
    { label: 'Contact', cell: (s) => s.contact, order: (s) => s.contact },
    { label: 'Hulls', cell: (s) => hulls(s.dimensions), order: (s) => s.dimensions },
    { label: 'Planes', cell: (s) => (s.coplanar ? 'coplanar' : 'skew'), order: (s) => Number(s.coplanar) },
    { label: 'Margin', numeric: true, cell: (s) => margin_words(s.margin), order: (s) => margin_order(s.margin) },
    { label: 'Lanes f32 · f64', title: 'Marks of the lanes: + false positive, − false negative, ? declined, . right', cell: marks, order: (s) => s.marks },
    { label: 'Card', cell: (s) => (s.card === null ? '' : h('button', { type: 'button', class: 'link', onclick: () => { open_card(s.card!); go_to(kind_id(s.card!)); } }, `card ${s.card + 1}`)), order: (s) => s.card ?? Infinity },
    { label: 'A pair', title: 'One of the pairs kept', cell: (s) => h('code', {}, pair_of(s)), order: (s) => pair_of(s) },
  ], { caption: 'Signatures listed', class: 'plain signatures', page: 12 });

  const shown = h('p', { class: 'readout', 'aria-live': 'polite' });
  const cell_note = h('div', { class: 'cell-note', 'aria-live': 'polite' });
  const none = h('p', { class: 'empty' }, 'No card passes the filter.');

  // What a cell of the league table leads to, above what is left of the table.
  function note(cell: Cell, rows: Signature[]) {
    const with_cards = rows.filter((s) => s.card !== null).length;
    const words = cell_words(report, cell);
    const clear = h('button', { type: 'button', onclick: () => { choose('cell', ''); update(); } }, 'Show all again');
    cell_note.replaceChildren(...(rows.length
      ? [h('p', {}, h('b', {}, words), `: ${count(rows.length)} signatures keep such pairs, ${with_cards || 'none'} of them with a card. `, clear),
        h('p', { class: 'label' }, 'One of them'), code_block(repro_command(report, cell, kept_pairs(report, cell, rows[0])[0]), 'the command that shows one')]
      : [h('p', {}, h('b', {}, words), ': no pair listed here shows it. ', clear)]),
    h('p', { class: 'label' }, 'All such pairs of the campaign again'), code_block(campaign_command(report, cell), 'the command that finds all'));
  }

  function update() {
    const cell = cell_of(report, chosen('cell')), algorithm = chosen('algorithm'), matches = matcher(chosen('find'));
    const passes = (s: Signature) => (!algorithm || s.algorithm === algorithm) && matches([s.key, signature_words(s), ...wrong_lanes(report, s)])
      && (!cell || kept_pairs(report, cell, s).length > 0);
    const rows = report.signatures.filter(passes);
    const listed = report.signatures.length < report.signature_count ? `the ${count(report.signatures.length)} commonest of ${count(report.signature_count)}` : `all ${count(report.signature_count)}`;
    shown.textContent = `${count(rows.length)} shown, of ${listed} signatures.`;
    table.show(rows);
    if (cell) note(cell, rows);
    else cell_note.replaceChildren();
    cards.forEach(({ details }, i) => (details.hidden = !passes(report.signatures[report.cards[i].signature])));
    const left = cards.filter(({ details }) => !details.hidden).length;
    card_count.textContent = left === cards.length ? `${left} cards` : `${left} of ${cards.length} cards`;
    none.hidden = left > 0;
  }
  const pair_of = (s: Signature) => {
    const cell = cell_of(report, chosen('cell'));
    return (cell && kept_pairs(report, cell, s)[0]) ?? s.pairs[0] ?? '';
  };
  const card_count = h('h3', {});
  const search = h('input', { type: 'search', placeholder: 'such as moller f64, or */f64/*', oninput: () => {
    choose('find', search.value.trim());
    update();
  } });
  const algorithms = [...new Set(report.signatures.map((s) => s.algorithm))];
  const by_algorithm = choice('Algorithm', [['', 'all'], ...algorithms.map((a): [string, string] => [a, a])], '', (value) => { choose('algorithm', value); update(); });
  const reread = () => {
    search.value = chosen('find');
    by_algorithm.querySelector('select')!.value = chosen('algorithm');
    update();
  };
  reread();
  when_chosen(reread);
  const all = (open: boolean) => () => cards.forEach((card) => (open ? card.open() : (card.details.open = false)));
  const element = section('signatures', 'Signatures',
    h('p', {}, 'Failures that look alike, counted together: how the triangles meet, how close the call was, and which lanes of the algorithm are wrong.'),
    h('div', { class: 'controls' }, h('label', { class: 'field' }, h('span', {}, 'Find'), search), by_algorithm),
    cell_note, shown, table.element,
    cards.length > 0 && h('div', { class: 'between cards-head' }, card_count,
      h('span', {}, h('button', { type: 'button', onclick: all(true) }, 'Open all'), h('button', { type: 'button', onclick: all(false) }, 'Close all'))),
    cards.length > 0 && none, cards.map(({ details }) => details));
  return {
    element,
    // Opens the card of that id, if it is one's.
    open: (id: string) => {
      const place = cards.findIndex((_, i) => kind_id(i) === id);
      if (place >= 0) open_card(place);
    },
  };
}
