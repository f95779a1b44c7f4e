// SPDX-License-Identifier: Apache-2.0
// The drawing. Dragging the background turns it, and dragging a vertex changes the pair.
import { orbit, view_of } from '../camera';
import { button, choice, h } from '../dom';
import { axes, framed_half_height, good_view, project, type Vec } from '../drawing';
import { svg_projection } from '../projection';
import { has_webgl, picture, type Picture } from '../view3d';
import { kCentres, without_changed, type Centre, type Model } from './model';
import { placed, type Field, type Placed } from './shape';

const kReach = 16; // pixels around a vertex within which it can be grabbed
const kTurn = Math.PI / 18;
const kFine = 1 / 64; // a drag with Shift moves a vertex by this fraction of the distance
const kGapSeen = 0.5; // length of the gap after "Show the gap", in half-widths of the board
const kFlat: Vec[] = [
  [0, 0, 0],
  [1, 0, 0],
  [0, 1, 0],
]; // sets the view if the drawing contains no polygon

export function board(model: Model, fields: () => Field | null) {
  let magnified = 1,
    now: Placed,
    drawn: Picture | null = null,
    old: Picture | null = null;
  const canvas = h('canvas', {}),
    paper = h('div', { class: 'paper' }),
    note = h('span', { class: 'scale-note' });
  const ground = h(
    'div',
    { class: 'board', id: 'board', tabindex: 0, role: 'application', 'aria-roledescription': 'turnable drawing' },
    canvas,
    paper,
  );
  const surround = h('div', {}, ground);
  place();
  const { camera, set } = orbit(ground, best_view(), draw, draw);

  // The 2012 triangles get the 2012 viewer's first view. Other triangles are seen from a direction in which they are
  // not edge-on.
  function best_view() {
    if (fields()?.of_2012) return { azimuth: 0, elevation: 0.56, zoom: 1 };
    const seen = [now.shape.a, now.shape.b].filter((polygon) => polygon.length > 2);
    return good_view({ ...now.shape, a: seen[0] ?? kFlat, b: seen[1] ?? seen[0] ?? kFlat });
  }

  function place() {
    now = placed(model, model.graze.drawing(model.pair), magnified, fields());
  }

  function draw() {
    if (!ground.clientWidth) return;
    const flat = !has_webgl();
    ground.classList.toggle('flat', flat);
    if (flat)
      return paper.replaceChildren(svg_projection(now.shape, view_of(camera), ground.clientWidth, ground.clientHeight));
    drawn ??= picture(now.shape);
    drawn.draw(canvas, camera);
    old?.dispose(); // not earlier: three.js deletes unused programs, which would then be recompiled
    old = null;
  }

  let last_name = '';
  function update() {
    const { truth } = model.decided,
      field = fields(),
      name = field ? 'many triangles' : without_changed(model.name);
    if (name !== last_name) magnified = 1; // a new pair starts with its best view
    place();
    if (name !== last_name) set(best_view());
    last_name = name;
    old ??= drawn;
    drawn = null;
    note.textContent = now.shape.note;
    contact_key.hidden = now.shape.contact.length === 0;
    witness_key.hidden = !now.shape.marks?.some(({ colour }) => colour === '--witness');
    gap_button.hidden = witness_key.hidden;
    gap_button.textContent = truth.verdict === 'disjoint' ? 'Show the gap' : 'Show the depth';
    witness_key.textContent =
      truth.verdict === 'disjoint' ? 'nearest points' : 'shortest push of b that separates the triangles';
    b_key.hidden = field !== null;
    field_keys.forEach((key) => (key.hidden = field === null));
    shadow_key.hidden = field !== null || !model.lane.startsWith('projected_sat/');
    line_key.hidden = now.shape.line.length === 0;
    centre_choice.querySelector('select')!.value = model.centre;
    ground.setAttribute(
      'aria-label',
      `${field ? field.title : `Two triangles, ${truth.verdict}, contact ${truth.contact}`}. Arrow keys turn and magnify; h lists all keys.`,
    );
    draw();
  }

  function magnify(by: number) {
    magnified = Math.min(2 ** 60, Math.max(0.25, magnified * by));
    update();
  }
  const turn = (azimuth: number, elevation: number) => {
    const view = view_of(camera);
    set({ azimuth: view.azimuth + azimuth * kTurn, elevation: view.elevation + elevation * kTurn });
  };
  // Centres the nearest points, or the shortest translation, and magnifies them until the distance is visible.
  function show_gap() {
    const [p, q] = model.graze.drawing(model.pair).witness;
    magnified = Math.min(
      2 ** 60,
      Math.max(1, (magnified * kGapSeen) / Math.hypot(...p.map((c, k) => (q[k] - c) / now.unit[k]))),
    );
    model.set({ centre: 'the contact or gap' });
  }
  function reset() {
    magnified = 1;
    place();
    set(best_view());
    model.set({ centre: 'both triangles' });
  }

  const local = (event: PointerEvent) => {
    const box = ground.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top, width: box.width, height: box.height };
  };
  // The vertex under the pointer, or the frontmost vertex if there are several.
  function taken(event: PointerEvent): number | null {
    const { x, y, width, height } = local(event);
    let best: { v: number; away: number; depth: number } | null = null;
    for (let v = 0; v < (fields() ? 3 : 6); ++v) {
      const p = [0, 1, 2].map((k) => (model.pair[3 * v + k] - now.middle[k]) / now.unit[k]) as Vec;
      const at = project(now.shape, p, view_of(camera), width, height),
        away = Math.hypot(at.x - x, at.y - y);
      if (away < kReach && (!best || away < best.away - 2 || (away < best.away + 2 && at.depth > best.depth)))
        best = { v, away, depth: at.depth };
    }
    return best && best.v;
  }
  // Runs before the orbit's own listener: a press on a vertex moves the vertex in the plane of the screen.
  surround.addEventListener(
    'pointerdown',
    (event) => {
      const v = event.button === 0 ? taken(event) : null;
      if (v === null) return;
      event.stopPropagation();
      event.preventDefault();
      ground.focus({ preventScroll: true });
      surround.setPointerCapture(event.pointerId);
      const start = { x: event.clientX, y: event.clientY },
        from = model.pair.slice(),
        placed_then = now,
        { height } = local(event);
      model.set({ chosen: 3 * v + (model.chosen % 3) });
      model.start_moving();
      const { right, up } = axes(view_of(camera));
      const pixel = (2 * framed_half_height(now.shape)) / height / camera.zoom;
      const move = (next: PointerEvent) => {
        const across = (next.clientX - start.x) * pixel,
          along = (start.y - next.clientY) * pixel;
        model.change((pair) => {
          const fine = next.shiftKey ? kFine : 1;
          for (let k = 0; k < 3; ++k)
            pair[3 * v + k] = from[3 * v + k] + (right[k] * across + up[k] * along) * placed_then.unit[k] * fine;
        });
      };
      surround.addEventListener('pointermove', move);
      const end = () => {
        surround.removeEventListener('pointermove', move);
        model.stop_moving();
      };
      surround.addEventListener('pointerup', end, { once: true });
      surround.addEventListener('pointercancel', end, { once: true });
    },
    { capture: true },
  );
  surround.addEventListener('pointermove', (event) => {
    const v = event.buttons ? null : taken(event);
    if (event.buttons) return;
    ground.toggleAttribute('data-over', v !== null);
    if (v !== null) ground.dataset.over = `${v < 3 ? 'a' : 'b'}[${v % 3}]`;
  });
  ground.addEventListener(
    'wheel',
    (event) => {
      if (document.activeElement !== ground) return; // without the focus, the wheel scrolls the page
      event.preventDefault();
      magnify(2 ** (-event.deltaY / 200));
    },
    { passive: false },
  );
  new ResizeObserver(draw).observe(ground);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', draw);

  const tool = (text: string, label: string, action: () => void) =>
    button(text, action, { 'aria-label': label, title: label });
  const centre_choice = choice(
    'Centre',
    kCentres.map((centre) => [centre, centre]),
    model.centre,
    (centre) => model.set({ centre: centre as Centre }),
  );
  const toggles = (['planes', 'axes', 'ids', 'coordinates'] as const).map((what) => ({
    what,
    box: button(what, () => model.toggle(what), { 'data-shows': what }),
  }));
  const contact_key = h('span', { class: 'key-contact' }, 'contact'),
    line_key = h('span', { class: 'key-line' }, 'the line where the planes meet, with both sections');
  const b_key = h('span', { class: 'key-b' }, 'b'),
    field_keys = [
      ['hit', 'hit'],
      ['other', 'not hit'],
      ['bad', 'outlined: wrong'],
    ].map(([colour, text]) => h('span', { class: `key-${colour}` }, text));
  const gap_button = tool('Show the gap', 'Magnify what the margin measures', show_gap);
  const witness_key = h('span', { class: 'key-witness' }),
    shadow_key = h('span', { class: 'key-shadow' }, 'b projected onto the plane of a, as projected_sat sees it');
  const element = h(
    'figure',
    { class: 'stage' },
    surround,
    h(
      'div',
      { class: 'stage-tools' },
      centre_choice,
      gap_button,
      tool('÷16', 'Magnify less', () => magnify(1 / 16)),
      tool('×16', 'Magnify', () => magnify(16)),
      tool('Reset', 'Reset the view', reset),
    ),
    h(
      'div',
      { class: 'chips', role: 'group', 'aria-label': 'Shown in the drawing' },
      toggles.map(({ box }) => box),
    ),
    h(
      'figcaption',
      {},
      h('span', { class: 'key-a' }, 'a'),
      b_key,
      field_keys,
      contact_key,
      line_key,
      witness_key,
      shadow_key,
      note,
      h(
        'span',
        {},
        'Drag a vertex to move it (with Shift for fine steps), or drag the background to turn the drawing.',
      ),
    ),
  );
  return {
    element,
    turn,
    magnify,
    reset,
    update: () => {
      toggles.forEach(({ what, box }) => box.setAttribute('aria-pressed', String(model.shows[what])));
      update();
    },
  };
}
