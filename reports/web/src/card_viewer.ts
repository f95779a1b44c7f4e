// SPDX-License-Identifier: Apache-2.0
// Shows a card's case in the viewer, in a dialog over the report. The page contains the viewer's module and data, which
// are unpacked when the first case is opened. The address stores the card, the pair and the lane:
// "#kind-7&p=…&by=moller_1997/f32/cuda-fma".
import { button, h } from './dom';
import { kind_words, within } from './kind';
import type { Report } from './report';
import { choose, chosen, into_viewer, out_of_viewer, place_of_address, when_chosen } from './state';
import { from_bits, stored_as, to_bits, type_of_bits, type Scalar, type Stored, type ViewData } from './viewer/data';
import type { Model } from './viewer/model';
import { make_ready, no_verdicts } from './viewer/ready';
import { viewer, type First } from './viewer/viewer';

type Card = Report['cards'][number];

// The viewer's module and data, for each coordinate type that the cards have.
type Parts = Partial<Record<Scalar, Stored>>;
let read: Parts | null | undefined;
const parts = () =>
  (read ??= JSON.parse(document.getElementById('view')?.textContent?.trim() || 'null') as Parts | null);
export const has_viewer = () => parts() !== null;

const bits_of = ({ coordinates, pair }: Card) => to_bits(stored_as(coordinates, pair.value));

// Returns a lane of the card's kind that is wrong on the pair shown and that the viewer can run; '' if none.
function lane_of(report: Report, { coordinates, kind, verdicts }: Card) {
  const lanes = parts()![coordinates]!.replay.lanes,
    wrong = verdicts
      .filter((one) => one.wrong)
      .map((one) => report.lanes[one.lane].id)
      .filter((id) => kind.lanes.includes(id));
  return wrong.find((id) => lanes.includes(id)) ?? '';
}

// "Stored verdicts: mine/f32/cpu says disjoint, which is wrong; …" for the lanes of the card's kind.
function stored_verdicts(report: Report, { kind, verdicts }: Card) {
  const own = verdicts.filter(({ lane }) => kind.lanes.includes(report.lanes[lane].id));
  const said = own.map(
    ({ lane, verdict, wrong }) => `${report.lanes[lane].id} says ${verdict}, which is ${wrong ? 'wrong' : 'right'}`,
  );
  return said.length ? `Stored verdicts: ${said.join('; ')}.` : `The lanes of this card: ${within(kind.lanes)}.`;
}

export const viewer_button = (report: Report, card: Card, id: string) =>
  has_viewer() &&
  button('Open in the viewer', () => into_viewer(id, bits_of(card), lane_of(report, card)), { class: 'in-viewer' });

// Opens the viewer if the address contains a pair, otherwise closes it: now, and after each change of the address.
export function follow_viewer(report: Report, id_of: (place: number) => string) {
  if (!has_viewer()) return;
  const names = report.cards.map((card, i) => `Card ${i + 1}: ${kind_words(card.kind)}`);
  const data_of = (type: Scalar): ViewData => ({
    ...parts()![type]!,
    format: 2,
    coordinates: type,
    title: 'cards of this report',
    pairs: report.cards.flatMap((card, i) =>
      card.coordinates === type ? [{ name: names[i], bits: bits_of(card) }] : [],
    ),
    triangles: [],
  });
  const inside = h('div', {}),
    dialog = h(
      'dialog',
      { id: 'viewer', 'aria-label': 'Viewer' },
      h('p', { class: 'back' }, button('← Back to the report', out_of_viewer)),
      inside,
    );
  document.body.append(dialog);
  dialog.addEventListener('cancel', (event) => {
    if (event.target !== dialog) return;
    event.preventDefault();
    out_of_viewer();
  });
  let shown: Promise<ReturnType<typeof viewer> | null> | null = null,
    shown_type: Scalar | null = null,
    kept = '';

  function first_of(bits: string, type: Scalar): First {
    const place = report.cards.findIndex((_, i) => id_of(i) === place_of_address()),
      card = report.cards[place];
    const first: First = { name: 'the pair of a link', pair: from_bits(bits, type), lane: chosen('by') };
    if (!card || bits_of(card) !== bits) return first;
    return {
      ...first,
      name: names[place],
      note: lane_of(report, card)
        ? ''
        : `${stored_verdicts(report, card)} These lanes are not in the viewer, because another compiler built it. The viewer shows the verdicts of the published lanes.`,
    };
  }
  async function start(first: First, type: Scalar) {
    inside.replaceChildren(h('p', { class: 'small', role: 'status' }, 'Checking the lanes against the native build …'));
    try {
      const data = data_of(type),
        made = viewer(data, await make_ready(data), first, {
          keep(model: Model) {
            choose('p', (kept = to_bits(model.pair)));
            choose('by', model.lane);
          },
          link: () => location.href,
          active: () => dialog.open,
        });
      inside.replaceChildren(
        h('div', { class: 'viewer-head' }, made.head),
        h('div', { class: 'viewer-body' }, made.body),
        made.help,
      );
      made.begin();
      return made;
    } catch (error) {
      inside.replaceChildren(...no_verdicts(error));
      return null;
    }
  }
  function follow() {
    const bits = chosen('p'),
      type = type_of_bits(bits),
      valid = type !== null && parts()![type] !== undefined;
    if (!valid && dialog.open) {
      dialog.close();
      document
        .getElementById(place_of_address())
        ?.querySelector<HTMLElement>('.in-viewer')
        ?.focus({ preventScroll: true });
    }
    if (!valid || (dialog.open && bits === kept)) return;
    kept = bits;
    if (!dialog.open) dialog.showModal();
    dialog.scrollTop = 0;
    const first = first_of(bits, type);
    if (shown && type === shown_type) void shown.then((made) => made?.show(first));
    else shown = start(first, (shown_type = type));
  }
  when_chosen(follow);
  follow();
}
