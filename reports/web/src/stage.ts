// SPDX-License-Identifier: Apache-2.0
// The drawing of a card. Dragging and keys turn it.
import { orbit, view_of } from './camera';
import { button, choice, h } from './dom';
import { good_frame, good_view, shape_of, type Frame } from './drawing';
import { svg_projection } from './projection';
import type { Report } from './report';
import { has_webgl, picture, type Picture } from './view3d';

const kTurn = Math.PI / 18;
const kZoom = 1.25;

// truth: a description of the drawing, for screen readers.
export function stage(card: Report['cards'][number], truth: string): HTMLElement {
  const frame = good_frame(card);
  let shape = shape_of(card, frame),
    visible = false;
  let drawn: Picture | null = null;
  const canvas = h('canvas', {}),
    paper = h('div', { class: 'paper' });
  const note = h('span', { class: 'scale-note' });
  const board = h(
    'div',
    {
      class: 'board',
      tabindex: 0,
      role: 'application',
      'aria-roledescription': 'turnable drawing',
      'aria-label': `Two triangles: ${truth}. Arrow keys turn the drawing, plus and minus zoom, 0 resets it.`,
    },
    canvas,
    paper,
  );

  const { camera, set } = orbit(board, good_view(shape), draw, draw_paper);

  function draw_paper() {
    paper.replaceChildren(svg_projection(shape, view_of(camera), 480, 360));
  }

  function draw() {
    if (!visible) return;
    if (has_webgl()) {
      drawn ??= picture(shape);
      drawn.draw(canvas, camera);
    }
    board.classList.toggle('flat', !has_webgl());
    if (!has_webgl()) draw_paper();
  }

  function look_at(frame: Frame) {
    shape = shape_of(card, frame);
    note.textContent = shape.note;
    drawn?.dispose();
    drawn = null;
    reset();
  }

  function reset() {
    set(good_view(shape));
    draw_paper();
  }

  board.addEventListener('keydown', (event) => {
    const { azimuth, elevation, zoom } = view_of(camera);
    const actions: Record<string, () => void> = {
      ArrowLeft: () => set({ azimuth: azimuth - kTurn }),
      ArrowRight: () => set({ azimuth: azimuth + kTurn }),
      ArrowUp: () => set({ elevation: elevation + kTurn }),
      ArrowDown: () => set({ elevation: elevation - kTurn }),
      '+': () => set({ zoom: zoom * kZoom }),
      '=': () => set({ zoom: zoom * kZoom }),
      '-': () => set({ zoom: zoom / kZoom }),
      '0': reset,
      Home: reset,
    };
    const action = event.ctrlKey || event.metaKey || event.altKey ? undefined : actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
    draw_paper();
  });

  new IntersectionObserver(
    ([entry]) => {
      visible = entry.isIntersecting;
      draw();
    },
    { rootMargin: '100px' },
  ).observe(board);
  new ResizeObserver(draw).observe(board);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', draw);

  note.textContent = shape.note;
  draw_paper();
  const tool = (text: string, label: string, action: () => void) => {
    const press = () => {
      action();
      draw_paper();
    };
    return button(text, press, { 'aria-label': label, title: label });
  };
  return h(
    'figure',
    { class: 'stage' },
    board,
    h(
      'div',
      { class: 'stage-tools' },
      choice(
        'Frame',
        [
          ['both', 'both triangles'],
          ['a', 'triangle a'],
          ['b', 'triangle b'],
        ],
        frame,
        (value) => look_at(value as Frame),
      ),
      tool('−', 'Zoom out', () => set({ zoom: camera.zoom / kZoom })),
      tool('+', 'Zoom in', () => set({ zoom: camera.zoom * kZoom })),
      tool('Reset', 'Reset the view', reset),
    ),
    h(
      'figcaption',
      {},
      h('span', { class: 'key-a' }, 'a'),
      h('span', { class: 'key-b' }, 'b'),
      card.drawing.contact.length > 0 && h('span', { class: 'key-contact' }, 'contact'),
      card.drawing.planes_line.length > 0 && h('span', { class: 'key-line' }, 'the planes’ line'),
      note,
    ),
  );
}
