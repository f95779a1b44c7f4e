// SPDX-License-Identifier: Apache-2.0
// Signatures: a table of all that are listed, and a card for each of the commonest.
import { card_element, hulls, margin_words, signature_words } from './card';
import { choice, h, section } from './dom';
import { count, percent } from './format';
import type { Report } from './report';
import { sortable_table } from './sortable_table';

type Signature = Report['signatures'][number];

const kOpenAtFirst = 2;

// "-2^-3" before "0" before "2^4", by size.
function margin_order(margin: string) {
  const found = /^([-+]?)2\^(-?\d+)$/.exec(margin);
  return found ? (found[1] === '-' ? -1 : 1) * (Number(found[2]) + 200) : 0;
}

export function signatures_section(report: Report) {
  const lanes_of = (algorithm: string) => report.lanes.filter((lane) => lane.algorithm === algorithm);
  const cards = report.cards.map((card, i) => card_element(report, card, i + 1));
  cards.slice(0, kOpenAtFirst).forEach(({ open }) => open());

  function marks({ algorithm, marks: text }: Signature) {
    const lanes = lanes_of(algorithm);
    const f64 = lanes.findIndex((lane) => lane.scalar === 'f64');
    return h('span', { class: 'marks' }, [...text].map((mark, i) =>
      h('span', { class: `${{ '+': 'plus', '-': 'minus' }[mark] ?? ''} ${i === f64 ? 'apart' : ''}`, title: `${lanes[i]?.id}: ${{ '+': 'false positive', '-': 'false negative', '?': 'declined', '.': 'right' }[mark] ?? 'did not run'}` }, mark === '-' ? '−' : mark)));
  }

  function show_card(place: number) {
    cards[place].open();
    cards[place].details.scrollIntoView({ block: 'start' });
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
    { label: 'Card', cell: (s) => (s.card === null ? '' : h('button', { type: 'button', class: 'link', onclick: () => show_card(s.card!) }, `card ${s.card + 1}`)), order: (s) => s.card ?? Infinity },
  ], { caption: 'Signatures listed', class: 'plain signatures', page: 12 });

  let text = '', algorithm = '';
  const shown = h('p', { class: 'readout', 'aria-live': 'polite' });
  const update = () => {
    const rows = report.signatures.filter((s) => (!algorithm || s.algorithm === algorithm) && (!text || `${s.key} ${signature_words(s)}`.toLowerCase().includes(text)));
    const listed = report.signatures.length < report.signature_count ? `the ${count(report.signatures.length)} commonest of ${count(report.signature_count)}` : `all ${count(report.signature_count)}`;
    shown.textContent = `${count(rows.length)} shown, of ${listed} signatures.`;
    table.show(rows);
  };
  update();
  const search = h('input', { type: 'search', placeholder: 'such as point, coplanar or ----', oninput: () => {
    text = search.value.trim().toLowerCase();
    update();
  } });
  const algorithms = [...new Set(report.signatures.map((s) => s.algorithm))];
  const all = (open: boolean) => () => cards.forEach((card) => (open ? card.open() : (card.details.open = false)));
  return section('signatures', 'Signatures',
    h('p', {}, 'Failures that look alike, counted together: how the triangles meet, how close the call was, and which lanes of the algorithm are wrong.'),
    h('div', { class: 'controls' }, h('label', { class: 'field' }, h('span', {}, 'Find'), search),
      choice('Algorithm', [['', 'all'], ...algorithms.map((a): [string, string] => [a, a])], '', (value) => { algorithm = value; update(); })),
    shown, table.element,
    cards.length > 0 && h('div', { class: 'between cards-head' }, h('h3', {}, `${cards.length} cards`),
      h('span', {}, h('button', { type: 'button', onclick: all(true) }, 'Open all'), h('button', { type: 'button', onclick: all(false) }, 'Close all'))),
    cards.map(({ details }) => details));
}
