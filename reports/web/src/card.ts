// SPDX-License-Identifier: Apache-2.0
// The card of a kind of failure: the simplest case, each lane's verdict on it, the explanation, and the commands that
// reproduce it.
import { viewer_button } from './card_viewer';
import { breakable, button, code_block, copy_button, h, lazy_details, list, scroller, table, table_row } from './dom';
import { counted, figure } from './format';
import { kind_facts, kind_lanes, kind_title } from './kind';
import type { Report } from './report';
import { stage } from './stage';

type Card = Report['cards'][number];

function coordinates({ pair }: Card) {
  const row = (v: number) =>
    table_row(
      `${v < 3 ? 'a' : 'b'}[${v % 3}]`,
      [3 * v, 3 * v + 1, 3 * v + 2].map((c) =>
        h('td', { class: 'number' }, h('span', {}, pair.decimal[c]), h('code', {}, pair.hex[c])),
      ),
    );
  const text = pair.hex.join(' ');
  return h(
    'div',
    { class: 'coordinates' },
    scroller(
      'Coordinates',
      table('plain', 'Coordinates, decimal and hex', ['', 'x', 'y', 'z'], [0, 1, 2, 3, 4, 5].map(row)),
    ),
    h(
      'p',
      { class: 'inline-copy' },
      'All 18 coordinates as hex floats, for ',
      h('code', {}, 'graze check -'),
      ' ',
      copy_button(text, 'the coordinates'),
    ),
  );
}

function verdicts(report: Report, card: Card) {
  const rows = new Map<string, Map<string, Card['verdicts'][number]>>();
  const targets: string[] = [];
  for (const verdict of card.verdicts) {
    const lane = report.lanes[verdict.lane];
    const name = `${lane.algorithm}/${lane.scalar}`;
    if (!rows.has(name)) rows.set(name, new Map());
    rows.get(name)!.set(lane.target, verdict);
    if (!targets.includes(lane.target)) targets.push(lane.target);
  }
  const cell = (verdict?: Card['verdicts'][number]) =>
    h('td', { class: verdict?.wrong ? 'bad' : '' }, verdict ? `${verdict.wrong ? '✗ ' : ''}${verdict.verdict}` : '–');
  return scroller(
    'Verdicts',
    table(
      'plain verdicts',
      'Verdict of every lane; wrong verdicts are marked',
      ['', ...targets],
      [...rows].map(([name, by_target]) =>
        table_row(
          breakable(name),
          targets.map((target) => cell(by_target.get(target))),
        ),
      ),
    ),
  );
}

function ulp_maps(maps: NonNullable<Card['maps']>) {
  return h(
    'div',
    { class: 'maps' },
    h('h4', {}, 'Ulp map'),
    h(
      'p',
      {},
      `${maps.title}: ${maps.x} to the right, ${maps.y} upwards; the case is in the middle. `,
      h(
        'span',
        { class: 'map-key' },
        maps.legend.map(({ colour, means }) => h('span', {}, h('i', { style: `background:${colour}` }), means)),
      ),
    ),
    h(
      'div',
      { class: 'panels' },
      maps.panels.map(({ name, shows, png }) =>
        h(
          'figure',
          { class: name === 'truth' ? 'panel truth' : 'panel' },
          h(
            'div',
            {},
            h('img', {
              src: `data:image/png;base64,${png}`,
              width: maps.size,
              height: maps.size,
              decoding: 'async',
              alt: `${name}: ${shows ?? 'the map’s counts are not stored'}`,
            }),
          ),
          h('figcaption', {}, name === 'truth' ? 'truth' : breakable(name.split('/').slice(1).join('/'))),
        ),
      ),
    ),
  );
}

// Buttons that each show or hide one of the card's programs. The report stores the algorithm's source only once, so the
// programs have @SOURCE@ in its place.
function snippets(report: Report, card: Card) {
  const shown = h('div', {});
  const buttons = card.snippets.map(({ label, text: without_source }) => {
    const text = without_source.replace('@SOURCE@', () => report.sources[card.kind.subject]);
    const press = () => {
      const open = own.getAttribute('aria-pressed') === 'true';
      buttons.forEach((other) => other.setAttribute('aria-pressed', 'false'));
      own.setAttribute('aria-pressed', String(!open));
      shown.replaceChildren(...(open ? [] : [code_block(text, `the ${label} snippet`)]));
    };
    const own = button(label, press, { 'aria-pressed': 'false' });
    return own;
  });
  return h('div', { class: 'snippets' }, h('h4', {}, 'For a bug report'), h('div', { class: 'chips' }, buttons), shown);
}

// "intersects, contact: point, margin 0"
function truth_words({ truth }: Card) {
  const where =
    truth.contact === 'none'
      ? `${figure(truth.margin)} apart`
      : truth.margin === 0
        ? `contact: ${truth.contact}, margin 0`
        : `contact: ${truth.contact}, ${figure(Math.abs(truth.margin))} deep`;
  return `${truth.verdict}, ${where}${truth.margin === 0 ? '' : ` (${figure(Math.abs(truth.margin_ulps))} ulps)`}`;
}

// Makes the contents of a card when the card is first opened.
function card_body(report: Report, card: Card, id: string) {
  const truth = truth_words(card),
    [verdict] = truth.split(',');
  return h(
    'div',
    { class: 'card-body' },
    kind_lanes(report, card),
    h(
      'div',
      { class: 'card-top' },
      h('div', {}, stage(card, truth), viewer_button(report, card, id)),
      h(
        'div',
        { class: 'card-facts' },
        h('p', { class: 'truth' }, h('b', {}, `Truth: ${verdict}`), truth.slice(verdict.length)),
        list(card.sentences, { class: 'sentences' }),
        coordinates(card),
      ),
    ),
    kind_facts(card),
    h(
      'div',
      { class: card.maps ? 'card-low' : '' },
      h('div', { class: 'card-facts' }, h('h4', {}, 'Verdicts'), verdicts(report, card)),
      card.maps && ulp_maps(card.maps),
    ),
    h('h4', {}, 'Reproduce'),
    h(
      'div',
      { class: 'commands' },
      card.commands.map(({ label, text }) => [
        h('span', { class: 'label' }, label),
        code_block(text, `the ${label} command`),
      ]),
    ),
    card.snippets.length > 0 && snippets(report, card),
    h(
      'p',
      { class: 'small' },
      card.minimised ? `Minimised from ${card.from}. ` : `Not minimised: this is ${card.from} as drawn. `,
      'Stored in ',
      h('code', {}, card.file),
      '. Kind: ',
      h('code', {}, ...breakable(card.kind.key)),
    ),
  );
}

// The id of the card at this index.
export const kind_id = (place: number) => `kind-${place + 1}`;

export function card_element(report: Report, card: Card, place: number) {
  return lazy_details(
    [
      h('span', { class: 'card-number' }, String(place + 1)),
      h('span', { class: 'card-title' }, kind_title(card.kind)),
      h(
        'span',
        { class: 'card-count' },
        `${counted(card.kind.pairs, 'pair')}, ${counted(card.kind.signatures, 'signature')}`,
      ),
    ],
    () => card_body(report, card, kind_id(place)),
    { class: 'card', id: kind_id(place) },
  );
}
