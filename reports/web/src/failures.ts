// SPDX-License-Identifier: Apache-2.0
// Failures: a card for each kind, and a table of the signatures behind the kinds. The same filters apply to both.
import { card_element, kind_id } from './card';
import { has_viewer } from './card_viewer';
import { button, code_block, h, paragraph, section } from './dom';
import { count, counted } from './format';
import { kept_choice, kept_search } from './kept';
import { kind_words } from './kind';
import {
  campaign_command,
  cell_of,
  cell_words,
  kept_pairs,
  repro_command,
  wrong_lanes,
  type Cell,
} from './pairs_of_cell';
import type { Report } from './report';
import { matcher } from './search';
import { signature_table, signature_words } from './signatures';
import { choose, chosen, when_chosen } from './state';

type Signature = Report['signatures'][number];

const kOpenAtFirst = 2;

export function failure_sections(report: Report) {
  const cards = report.cards.map((card, i) => card_element(report, card, i));
  cards.slice(0, kOpenAtFirst).forEach(({ open }) => open());

  function open_card(place: number) {
    cards[place].details.hidden = false;
    cards[place].open();
    cards[place].details.querySelector('summary')?.focus({ preventScroll: true });
  }

  const pair_of = (s: Signature) => {
    const cell = cell_of(report, chosen('cell'));
    return (cell && kept_pairs(report, cell, s)[0]) ?? s.pairs[0] ?? '';
  };
  const table = signature_table(report, pair_of);

  const shown = h('p', { class: 'readout', 'aria-live': 'polite' });
  const cell_note = h('div', { class: 'cell-note', 'aria-live': 'polite' });
  const none = h('p', { class: 'empty' }, 'No card passes the filter.');
  const card_count = h('h3', {});

  // Describes the chosen cell of the league table, above the cards and the signature table.
  function note(cell: Cell, rows: Signature[], left: number) {
    const words = cell_words(report, cell);
    const clear = button('Show all again', () => {
      choose('cell', '');
      update();
    });
    cell_note.replaceChildren(
      ...(rows.length
        ? [
            paragraph(
              h('b', {}, words),
              `: ${counted(rows.length, 'signature')} ${rows.length === 1 ? 'keeps' : 'keep'} such pairs, from ${left ? counted(left, 'kind') : 'no kind'} with a card. `,
              clear,
            ),
            h('p', { class: 'label' }, 'Show one such pair again'),
            code_block(
              repro_command(report, cell, kept_pairs(report, cell, rows[0])[0]),
              'the command that shows one such pair',
            ),
          ]
        : [paragraph(h('b', {}, words), ': no pair listed here shows such a verdict. ', clear)]),
      h('p', { class: 'label' }, 'Find all such pairs of the campaign again'),
      code_block(campaign_command(report, cell), 'the command that finds all such pairs'),
    );
  }

  // The search for kinds matches their properties and lanes. The search for signatures also matches their kinds' names.
  const names_of = ({ kind }: Report['cards'][number]) => [kind.key, kind_words(kind), kind.line];

  function update() {
    const cell = cell_of(report, chosen('cell')),
      algorithm = by_algorithm.value(),
      matches = matcher(chosen('find'));
    const rows = report.signatures.filter(
      (s) =>
        (!algorithm || s.algorithm === algorithm) &&
        (!cell || kept_pairs(report, cell, s).length > 0) &&
        matches([
          s.key,
          signature_words(s),
          ...wrong_lanes(report, s),
          ...s.cards.flatMap((place) => names_of(report.cards[place])),
        ]),
    );
    const listed =
      report.signatures.length < report.signature_count
        ? `the ${count(report.signatures.length)} most common of ${count(report.signature_count)}`
        : `all ${count(report.signature_count)}`;
    shown.textContent = `${count(rows.length)} shown, of ${listed} signatures.`;
    table.show(rows);

    // A card is shown for a cell if a listed signature belongs to its kind and the cell's lane is one of the kind's
    // lanes. Kinds do not record which lanes differ from the cpu lane, so for that error the signature is enough.
    const of_cell = cell && new Set(rows.flatMap((s) => s.cards));
    const shows = (place: number) =>
      !of_cell ||
      (of_cell.has(place) &&
        (cell.kind === 'differs_from_cpu' || report.cards[place].kind.lanes.includes(report.lanes[cell.lane].id)));
    report.cards.forEach(
      (card, i) =>
        (cards[i].details.hidden = !(
          (!algorithm || card.kind.subject === algorithm) &&
          shows(i) &&
          matches([...names_of(card), ...card.kind.lanes])
        )),
    );
    const left = cards.filter(({ details }) => !details.hidden).length;
    card_count.textContent =
      left === cards.length ? counted(left, 'card') : `${left} of ${counted(cards.length, 'card')}`;
    none.hidden = left > 0;
    if (cell) note(cell, rows, left);
    else cell_note.replaceChildren();
  }

  const search = kept_search('find', 'Find', 'moller f64, or *.h:117*', update);
  const algorithms = [...new Set(report.signatures.map((s) => s.algorithm))];
  const by_algorithm = kept_choice(
    'algorithm',
    'Algorithm',
    [['', 'all'], ...algorithms.map((a): [string, string] => [a, a])],
    update,
  );
  update();
  when_chosen(update);
  const all = (open: boolean) => () => cards.forEach((card) => (open ? card.open() : (card.details.open = false)));
  const sections = [
    section(
      'kinds',
      'Kinds of failure',
      paragraph(
        'A kind groups failures with the same algorithm, cause, deciding source line and shape. The shape is degenerate, contained (one triangle in the other, in the same plane), coplanar or general. A pair on which lanes are wrong for different reasons belongs to several kinds. Graze examines one pair of each signature; in these counts it represents all pairs of that signature.',
        !has_viewer() &&
          ' Cards do not open in the viewer, because graze was built without the compiler for WebAssembly that the viewer needs.',
      ),
      h('div', { class: 'controls' }, search, by_algorithm.element),
      cell_note,
      cards.length > 0 && [
        h(
          'div',
          { class: 'between cards-head' },
          card_count,
          h('span', {}, button('Open all', all(true)), button('Close all', all(false))),
        ),
        none,
        cards.map(({ details }) => details),
      ],
    ),
    section(
      'signatures',
      'Signatures',
      paragraph(
        'A signature counts failures that look alike: the same contact, a similar margin, and the same wrong lanes of the algorithm. The filters above the kinds of failure apply here too.',
      ),
      shown,
      table.element,
    ),
  ];
  return {
    sections,
    // Opens the card with this id, if there is one.
    open: (id: string) => {
      const place = cards.findIndex((_, i) => kind_id(i) === id);
      if (place >= 0) open_card(place);
    },
  };
}
