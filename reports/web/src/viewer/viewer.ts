// SPDX-License-Identifier: Apache-2.0
// The viewer: prepares the module, checks it against the native build, and assembles the display.
import './viewer.css';
import compressed from 'graze.wasm';
import { h } from '../dom';
import { figure } from '../format';
import { board } from './board';
import { coordinates, kMove } from './coordinates';
import { copies } from './copies';
import { replay, type Coordinates, type Replay, type ViewData } from './data';
import { field } from './field';
import { load, type Drawing, type Graze } from './graze.js';
import { keys } from './keys';
import { map } from './map';
import { matrix } from './matrix';
import { kCentres, Model } from './model';
import { on_a_line } from './on_a_line';
import { policy } from './policy';
import { sources } from './sources';
import { show_why } from './apart';
import { why } from './why';
import { words } from './words';

async function module_of(base64: string): Promise<WebAssembly.Module> {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  return WebAssembly.compile(await new Response(stream).arrayBuffer());
}

function margin_words({ decided: { truth, margin } }: Model): string {
  if (truth.verdict === 'declined') return 'a coordinate is not finite';
  if (margin.sign === 0) return 'margin exactly 0: any push parts them';
  const say = (x: number) => figure(x),
    [least, most] = [say(margin.least), say(margin.most)];
  const ulps = (x: number) => say(x / margin.ulp);
  const range =
    least === most
      ? `${least} (${ulps(margin.least)} ulps)`
      : `between ${least} and ${most} (${ulps(margin.least)} to ${ulps(margin.most)} ulps)`;
  return margin.sign > 0 ? `${range} apart` : `${range} deep`;
}

export interface Ready {
  graze: Graze;
  module: WebAssembly.Module;
  said: string;
}

// Returns the module after it has decided the stored pairs.   Throws: its differences from the native build, in words.
export async function make_ready(stored: Replay): Promise<Ready> {
  const module = await module_of(compressed),
    graze = await load(module),
    apart = replay(graze, stored);
  if (apart.length)
    throw new Error(
      `This browser decides otherwise than the native build: ${apart.slice(0, 3).join('; ')}${apart.length > 3 ? `; and ${apart.length - 3} more` : ''}.`,
    );
  return {
    graze,
    module,
    said: `Same as the native build on ${stored.pairs.length} pairs, ${stored.lanes.length} lanes each.`,
  };
}

export const no_verdicts = (error: unknown) => [
  h('h1', {}, 'No verdicts'),
  h('p', { class: 'notice', role: 'alert', id: 'warning' }, String(error instanceof Error ? error.message : error)),
  h('p', {}, 'The same pair in a terminal: ', h('code', {}, 'graze check FILE'), '.'),
];

// The page around the viewer: its address stores the pair; keys work while it is active.
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

// The vertex nearest to the contact or the gap, because moving and mapping it shows most.
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
    many = field(model, data, () => update_drawing()),
    drawing = board(model, many.current),
    typed = coordinates(model, say),
    ulps = map(model, module),
    line = on_a_line(model),
    from = sources(model, data, say),
    copied = copies(model, around.link);
  const tool = (text: string, action: () => void) => h('button', { type: 'button', onclick: action }, text);
  const undo = tool('Undo', () => model.travel('past')),
    redo = tool('Redo', () => model.travel('future'));
  const name = h('h1', {}),
    truth = h('p', { class: 'truth', id: 'truth' }),
    summary = h('p', { id: 'summary' });

  // Updates text at once, drawings with the next frame, and slower parts after a moment of rest.
  function update_text() {
    verdicts.update();
    const { decided, policy: under } = model,
      wrong = graze.lanes.filter((lane) => model.wrong(lane)),
      apart = graze.lanes.filter((lane) => lane.endsWith('/cuda-fma') && model.differs(lane));
    name.textContent = model.name;
    truth.replaceChildren(
      h('strong', {}, `Truth: ${decided.truth.verdict}`),
      `, ${decided.truth.contact === 'none' || decided.truth.verdict === 'declined' ? '' : `contact: ${decided.truth.contact}, `}${margin_words(model)}${decided.truth.coplanar ? '; coplanar' : ''}`,
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
            h(
              'button',
              {
                type: 'button',
                class: 'link',
                onclick: () => {
                  model.set({ lane });
                  show_why();
                },
              },
              lane.replace('/cuda-fma', ''),
            ),
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
    typed.update();
    from.update();
  }
  function update_drawing() {
    cancelAnimationFrame(frame);
    frame = 0;
    many.update();
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
  const moves: [string, number, number, string][] = [
    ['a', 0, -kMove, '−x'],
    ['d', 0, kMove, '+x'],
    ['s', 1, -kMove, '−y'],
    ['w', 1, kMove, '+y'],
    ['q', 2, -kMove, '−z'],
    ['e', 2, kMove, '+z'],
  ];
  const show = (what: keyof Model['shows']) => () =>
    model.set({ shows: { ...model.shows, [what]: !model.shows[what] } });
  const by = (event: KeyboardEvent) => (event.altKey ? 65536 : event.shiftKey ? 256 : 1);
  const pressed = keys(
    [
      { keys: ['h', '?'], shown: 'h', does: 'this help', of_2012: true, press: () => pressed.toggle() },
      {
        keys: ['ArrowLeft'],
        shown: '←',
        does: 'turn left',
        of_2012: true,
        on_board: true,
        press: () => drawing.turn(-1, 0),
      },
      {
        keys: ['ArrowRight'],
        shown: '→',
        does: 'turn right',
        of_2012: true,
        on_board: true,
        press: () => drawing.turn(1, 0),
      },
      {
        keys: ['ArrowUp'],
        shown: '↑',
        does: 'magnify; with Shift tilt up',
        of_2012: true,
        on_board: true,
        press: (event) => (event.shiftKey ? drawing.turn(0, 1) : drawing.magnify(1.5)),
      },
      {
        keys: ['ArrowDown'],
        shown: '↓',
        does: 'magnify less; with Shift tilt down',
        of_2012: true,
        on_board: true,
        press: (event) => (event.shiftKey ? drawing.turn(0, -1) : drawing.magnify(1 / 1.5)),
      },
      ...moves.map(([key, axis, step, where]) => ({
        keys: [key],
        shown: key,
        does: `move the first triangle by ${kMove} along ${where}`,
        of_2012: true,
        press: () => model.move_reference(axis, step),
      })),
      { keys: ['o'], shown: 'o', does: 'axes', of_2012: true, press: show('axes') },
      { keys: ['c'], shown: 'c', does: 'coordinates', of_2012: true, press: show('coordinates') },
      { keys: ['i'], shown: 'i', does: 'ids of the vertices', of_2012: true, press: show('ids') },
      { keys: ['p'], shown: 'p', does: 'planes', of_2012: true, press: show('planes') },
      {
        keys: ['t'],
        shown: 't',
        does: 'the next of the ten special cases',
        of_2012: true,
        press: () => from.next_special(),
      },
      {
        keys: ['g'],
        shown: 'g',
        does: 'the chosen lane on the CPU or on the GPU',
        of_2012: true,
        press: other_processor,
      },
      {
        keys: ['+', '='],
        shown: '+',
        does: 'more triangles against the first',
        of_2012: true,
        press: () => many.more(),
      },
      { keys: ['-'], shown: '-', does: 'fewer', of_2012: true, press: () => many.fewer() },
      {
        keys: [' '],
        shown: 'space',
        does: 'new random triangles',
        of_2012: true,
        on_board: true,
        press: () => many.again(),
      },
      {
        keys: ['n'],
        shown: 'n',
        does: 'next pair; with Shift the next on which CPU and GPU differ',
        press: (event) => void from.go(1, event.shiftKey ? 'apart' : 'any'),
      },
      { keys: ['b'], shown: 'b', does: 'previous pair', press: () => void from.go(-1) },
      ...['0', '1', '2', '3', '4', '5'].map((key, v) => ({
        keys: [key],
        shown: key,
        does: `choose vertex ${v < 3 ? 'a' : 'b'}[${v % 3}]`,
        press: () => model.set({ chosen: 3 * v + (model.chosen % 3) }),
      })),
      ...['x', 'y', 'z'].map((key, k) => ({
        keys: [key],
        shown: key,
        does: `choose its ${key}`,
        press: () => model.set({ chosen: model.vertex + k }),
      })),
      {
        keys: ['['],
        shown: '[',
        does: 'the chosen coordinate an ulp down; with Shift 256, with Alt 65,536',
        press: (event) => model.step(-by(event)),
      },
      { keys: [']'], shown: ']', does: 'the same, up', press: (event) => model.step(by(event)) },
      {
        keys: ['f'],
        shown: 'f',
        does: 'what is in the middle: both triangles, the chosen vertex, the contact or gap',
        press: () => model.set({ centre: kCentres[(kCentres.indexOf(model.centre) + 1) % kCentres.length] }),
      },
      { keys: ['Home'], shown: 'Home', does: 'the view as it was', on_board: true, press: () => drawing.reset() },
      {
        keys: ['u'],
        shown: 'u',
        does: 'undo; also Ctrl+Z',
        with_control: 'z',
        press: () => model.travel('past') || say('nothing to undo'),
      },
      {
        keys: ['r'],
        shown: 'r',
        does: 'redo; also Ctrl+Y',
        with_control: 'y',
        press: () => model.travel('future') || say('nothing to redo'),
      },
    ],
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
    head: [name, h('p', { class: 'small' }, 'Two triangles: do they intersect?')],
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
            tool('Switch CPU/GPU', other_processor),
            tool('Random triangles', () => many.again()),
            tool('Keys (h)', () => pressed.toggle()),
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
        verdicts.element,
        because.element,
        line.element,
        ulps.element,
        h(
          'section',
          { id: 'policy', 'aria-labelledby': 'policy-title' },
          h('h2', { id: 'policy-title' }, 'Tolerances'),
          policy(model),
        ),
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
    // To be called once its elements are in the page.
    begin() {
      choose(first);
      if (data.opens === 'triangles') many.all();
      update_drawing();
      update_later();
      document.getElementById('board')!.focus({ preventScroll: true });
    },
  };
}
