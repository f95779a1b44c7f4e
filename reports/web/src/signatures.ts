// SPDX-License-Identifier: Apache-2.0
// The table of signatures.
import { kind_id } from './card';
import { h } from './dom';
import { margin_order, margin_words, percent } from './format';
import type { Report } from './report';
import { counts, sortable_table } from './sortable_table';

type Signature = Report['signatures'][number];

const kHulls = ['point', 'segment', 'triangle'];
function hulls(dimensions: string, how = '') {
  const [a, b] = [...dimensions].map((d) => kHulls[Number(d)] ?? d);
  return a === b ? `two ${how}${a}s` : `a ${how}${a} and a ${b}`;
}
const kContacts: Record<string, string> = {
  none: 'apart',
  point: 'meeting in a point',
  segment: 'meeting in a segment',
  area: 'meeting in an area',
};

const kNestings = { a_in_b: ', a in b', b_in_a: ', b in a', same: ', same' };
const planes = (s: Signature) => `${s.coplanar ? 'coplanar' : 'skew'}${s.nesting ? kNestings[s.nesting] : ''}`;

export function signature_words(signature: Signature): string {
  const { contact, dimensions, coplanar, margin, nesting } = signature;
  return `${hulls(dimensions, coplanar ? 'coplanar ' : '')} ${kContacts[contact] ?? contact}${nesting ? kNestings[nesting] : ''}, margin ${margin_words(margin)}`;
}

// pair_of: returns the pair to show for a signature.
export function signature_table(report: Report, pair_of: (signature: Signature) => string) {
  function marks({ algorithm, marks: text }: Signature) {
    const lanes = report.lanes.filter((lane) => lane.algorithm === algorithm);
    const f64 = lanes.findIndex((lane) => lane.scalar === 'f64');
    return h(
      'span',
      { class: 'marks' },
      [...text].map((mark, i) =>
        h(
          'span',
          {
            class: `${{ '+': 'plus', '-': 'minus' }[mark] ?? ''} ${i === f64 ? 'apart' : ''}`,
            title: `${lanes[i]?.id}: ${{ '+': 'false positive', '-': 'false negative', '?': 'declined', '!': 'crashed', '@': 'timed out', '%': 'unstable', '.': 'right' }[mark] ?? 'did not run'}`,
          },
          mark === '-' ? '−' : mark,
        ),
      ),
    );
  }

  const kinds = ({ cards }: Signature) =>
    cards.map((place, i) => [i > 0 && ' ', h('a', { class: 'link', href: `#${kind_id(place)}` }, `kind ${place + 1}`)]);

  return sortable_table<Signature>(
    [
      { label: 'No.', numeric: true, cell: (s) => String(report.signatures.indexOf(s) + 1), order: (s) => -s.count },
      counts('Pairs', (s) => s.count),
      { label: 'Share', numeric: true, cell: (s) => percent(s.share), order: (s) => s.share },
      { label: 'Algorithm', cell: (s) => s.algorithm, order: (s) => s.algorithm },
      { label: 'Contact', cell: (s) => s.contact, order: (s) => s.contact },
      { label: 'Hulls', cell: (s) => hulls(s.dimensions), order: (s) => s.dimensions },
      { label: 'Planes', cell: planes, order: planes },
      { label: 'Margin', numeric: true, cell: (s) => margin_words(s.margin), order: (s) => margin_order(s.margin) },
      {
        label: 'Lanes f32 · f64',
        title: 'Marks of the lanes: + false positive, − false negative, ? declined, . right',
        cell: marks,
        order: (s) => s.marks,
      },
      {
        label: 'Kinds',
        title: 'The kinds of failure, among those with a card, to which the signature belongs',
        cell: kinds,
        order: (s) => s.cards[0] ?? Infinity,
      },
      {
        label: 'A pair',
        title: 'One of the kept pairs',
        cell: (s) => h('code', {}, pair_of(s)),
        order: (s) => pair_of(s),
      },
    ],
    { caption: 'Listed signatures', class: 'plain signatures', page: 12 },
  );
}
