// SPDX-License-Identifier: Apache-2.0
// Assembles the viewer from its parts.
import './viewer.css';
import { button, h, section } from '../dom';
import { figure } from '../format';
import { all_keys } from './all_keys';
import { show_why } from './apart';
import { board } from './board';
import { coordinates } from './coordinates';
import { copies } from './copies';
import type { Coordinates, ViewData } from './data';
import { field } from './field';
import type { Drawing } from './graze.js';
import { keys } from './keys';
import { map } from './map';
import { matrix } from './matrix';
import { Model } from './model';
import { on_a_line } from './on_a_line';
import { own_code } from './own_code';
import { policy } from './policy';
import type { Ready } from './ready';
import { sources } from './sources';
import { why } from './why';
import { words } from './words';

function margin_words({ decided: { truth, margin } }: Model): string {
  if (truth.verdict === 'declined') return 'a coordinate is not finite';
  if (margin.sign === 0) return 'margin exactly 0: an arbitrarily short push separates the triangles';
  const [least, most] = [figure(margin.least), figure(margin.most)];
  const ulps = (x: number) => figure(x / margin.ulp);
  if (margin.most === Infinity) return 'margin not settled here: the pair’s sizes are too far apart';
  const range =
    least === most
      ? `${least} (${ulps(margin.least)} ulps)`
      : `between ${least} and ${most} (${ulps(margin.least)} to ${ulps(margin.most)} ulps)`;
  return margin.sign > 0 ? `${range} apart` : `${range} deep`;
}

// The truth of the pair rounded to float32, if it differs from the truth of the doubles.
function stored_words({ decided: { truth, stored } }: Model): string {
  if (!stored || (stored.verdict === truth.verdict && stored.contact === truth.contact)) return '';
  if (stored.verdict === 'declined') return '; float32 cannot store it';
  return `; as float32 stores it: ${stored.verdict}${stored.contact === 'none' ? '' : `, contact: ${stored.contact}`}`;
}

// The page around the viewer. The page's address stores the pair, and keys work while the viewer is active.
export interface Around {
  keep: (model: Model) => void;
  link: (model: Model) => string;
  active: () => boolean;
}
export interface First {
  name: string;
  pair: Coordinates;
  lane?: string;
  note?: string;
}

// The vertex nearest to the contact or the gap; moving it, or mapping around it, shows the most.
function nearest_vertex(pair: Coordinates, { contact, witness }: Drawing): number {
  const seen = contact.length ? contact : witness,
    away = [3, 4, 5, 0, 1, 2].map((v) => ({
      v,
      least: Math.min(...seen.map((p) => Math.hypot(...p.map((c, k) => c - pair[3 * v + k])))),
    }));
  return away.reduce((best, one) => (one.least < best.least ? one : best)).v;
}

export function viewer(data: ViewData, { graze, module, said }: Ready, first: First, around: Around) {
  const message = h('p', { class: 'message small', role: 'status' });
  const say = (text: string) => (message.textContent = text);
  let later = 0,
    frame = 0;
  const model = new Model(graze, first, (moved) => {
    if (moved) say('');
    update_text();
    if (!frame) frame = requestAnimationFrame(update_drawing);
    clearTimeout(later);
    later = window.setTimeout(update_later, 60);
  });
  const verdicts = matrix(model),
    because = why(model),
    many = field(model, data, say, () => update_drawing()),
    drawing = board(model, many.current),
    typed = coordinates(model, say),
    ulps = map(model, module),
    line = on_a_line(model),
    own = own_code(model, data),
    from = sources(model, data, say),
    copied = copies(model, around.link);
  const undo = button('Undo', () => model.travel('past')),
    redo = button('Redo', () => model.travel('future'));
  const name = h('h1', {}),
    truth = h('p', { class: 'truth', id: 'truth' }),
    summary = h('p', { id: 'summary' });

  const update_name = () => (name.textContent = many.title() ?? model.name);

  // Updates text at once, drawings at the next frame, and slower parts after a moment without changes.
  function update_text() {
    verdicts.update();
    const { decided, policy: under } = model,
      wrong = graze.lanes.filter((lane) => model.wrong(lane)),
      apart = graze.lanes.filter((lane) => lane.endsWith('/cuda-fma') && model.differs(lane));
    update_name();
    truth.replaceChildren(
      h('strong', {}, `Truth: ${decided.truth.verdict}`),
      `, ${decided.truth.contact === 'none' || decided.truth.verdict === 'declined' ? '' : `contact: ${decided.truth.contact}, `}${margin_words(model)}${decided.truth.coplanar ? '; coplanar' : ''}${stored_words(model)}`,
    );
    undo.disabled = !model.can('past');
    redo.disabled = !model.can('future');
    summary.replaceChildren(
      h(
        'span',
        {},
        apart.length > 0 && [
          'CPU and GPU differ: ',
          apart.map((lane, i) => [
            i ? ', ' : '',
            button(lane.replace('/cuda-fma', ''), () => (model.set({ lane }), show_why()), { class: 'link' }),
          ]),
          '. ',
        ],
        wrong.length
          ? h(
              'b',
              { class: 'bad' },
              `${wrong.length} of ${graze.lanes.length} lanes ${wrong.length === 1 ? 'is' : 'are'} wrong`,
            )
          : `All ${graze.lanes.length} lanes are right`,
        under && ` under ${under}`,
        apart.length > 0 &&
          wrong.length > 0 &&
          `, ${apart.filter((lane) => model.wrong(lane)).length || 'none'} of them only on the GPU`,
        '.',
      ),
    );
    because.brief.hidden = apart.length === 0;
    own.update();
    typed.update();
    from.update();
  }
  function update_drawing() {
    cancelAnimationFrame(frame);
    frame = 0;
    many.update();
    update_name();
    drawing.update();
  }
  function update_later() {
    because.update();
    line.update();
    copied.update();
    ulps.update();
    if (around.active()) around.keep(model);
  }

  const other_processor = () => {
    const [, , variant] = model.lane.split('/'),
      to = variant === 'cpu' ? ['cuda-fma', 'cuda'] : ['cpu'];
    const lane = to.map((one) => model.counterpart(model.lane, one)).find(Boolean);
    if (lane) model.set({ lane });
    say(`Chosen: ${model.lane}, ${variant === 'cpu' ? 'GPU' : 'CPU'}`);
  };
  const pressed = keys(
    all_keys({ model, drawing, many, from, say, other_processor, toggle_help: () => pressed.toggle() }),
    around.active,
  );
  function choose({ pair, lane, note }: First) {
    from.find(pair);
    model.set({ chosen: 3 * nearest_vertex(pair, graze.drawing(pair)) });
    if (lane && graze.lanes.includes(lane)) model.set({ lane });
    else model.choose_telling();
    say(note ?? '');
  }
  return {
    head: [name, h('p', { class: 'small' }, 'Do these triangles intersect?')],
    body: [
      h(
        'div',
        { class: 'column' },
        h(
          'div',
          { class: 'seen' },
          drawing.element,
          many.element,
          h('div', { class: 'notes' }, message, verdicts.told),
        ),
        h(
          'div',
          { class: 'tools' },
          h(
            'div',
            { class: 'chips' },
            undo,
            redo,
            button('Switch CPU/GPU', other_processor),
            button('Random triangles', many.again),
            button('Keys (h)', () => pressed.toggle()),
          ),
          from.element,
        ),
        typed.element,
        copied.element,
      ),
      h(
        'div',
        { class: 'column' },
        h('div', { class: 'said' }, truth, summary, because.brief),
        own.element,
        verdicts.element,
        because.element,
        line.element,
        ulps.element,
        section('policy', 'Tolerances', policy(model)),
        words(),
        h('p', { class: 'small', id: 'replayed' }, said),
        h('p', { class: 'small', id: 'evidence' }, `CUDA lanes: ${data.evidence}; here in WebAssembly.`),
      ),
    ],
    help: pressed.help,
    show(next: First) {
      model.show(next.pair, next.name);
      choose(next);
    },
    // Call this once the elements are in the page.
    begin() {
      choose(first);
      if (data.opens === 'triangles' || data.opens === 'random') many.all();
      update_drawing();
      update_later();
      document.getElementById('board')!.focus({ preventScroll: true });
    },
  };
}
