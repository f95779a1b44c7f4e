// SPDX-License-Identifier: Apache-2.0
// The pair as a shape to draw. Exact differences from the centre are magnified in double before they are rounded to
// float32, so a single ulp is visible. Parts far outside the drawing are cut off first.
import { cross, dot, drawn_sizes, fan, minus, scale_note, type Mark, type Shape, type Vec } from '../drawing';
import { figure } from '../format';
import { decimal, type Coordinates } from './data';
import type { Drawing } from './graze.js';
import type { Model } from './model';

const kFar = 40; // distance in half-widths of the board beyond which polygons are cut

export interface Placed {
  shape: Shape;
  unit: Vec;
  middle: Vec;
} // unit: the length in coordinates that is 1 in the shape

const vertex = (pair: Coordinates, v: number) => [pair[3 * v], pair[3 * v + 1], pair[3 * v + 2]] as Vec;
const corners_of = (triangle: Coordinates) => [0, 1, 2].map((v) => vertex(triangle, v));

// The part of a convex polygon or of a segment that is within the box.
function cut(polygon: Vec[]): Vec[] {
  let points = polygon;
  for (let axis = 0; axis < 3; ++axis) {
    for (const side of [1, -1]) {
      const height = (p: Vec) => kFar - side * p[axis],
        kept: Vec[] = [];
      points.forEach((p, i) => {
        const q = points[(i + 1) % points.length],
          at = height(p),
          next = height(q);
        if (at >= 0) kept.push(p);
        if (at * next < 0 && !(points.length === 2 && i === 1))
          kept.push(p.map((c, k) => c + (q[k] - c) * (at / (at - next))) as Vec);
      });
      points = kept;
    }
  }
  return points;
}

function plane(corners: Vec[]): Vec[] {
  const [p, q, r] = corners,
    u = minus(q, p),
    n = cross(u, minus(r, p));
  const length = Math.hypot(...n),
    size = Math.hypot(...u);
  if (!(length > 0) || !(size > 0)) return [];
  const e = u.map((c) => (2.2 * c) / size),
    f = cross(n, u).map((c) => (2.2 * c) / (length * size));
  const middle = corners[0].map((_, k) => (p[k] + q[k] + r[k]) / 3);
  return [
    [1, 1],
    [1, -1],
    [-1, -1],
    [-1, 1],
  ].map(([s, t]) => middle.map((c, k) => c + s * e[k] + t * f[k]) as Vec);
}

// b's vertices projected onto a's plane; projected_sat compares no other part of b. Empty if triangle a has no plane.
function shadow_of(points: Vec[]): Vec[] {
  const [p, q, r] = points,
    n = cross(minus(q, p), minus(r, p)),
    square = dot(n, n);
  if (!(square > 0) || !Number.isFinite(square)) return [];
  return points.slice(3).map((b) => {
    const height = dot(n, minus(b, p)) / square;
    return b.map((c, k) => c - n[k] * height) as Vec;
  });
}

export interface Field {
  title: string;
  of_2012: boolean;
  triangles: Coordinates[]; // 9 coordinates each
  ids: number[];
  hit: boolean[];
  wrong: boolean[];
}

const middle_of = (corners: Vec[]) => corners[0].map((_, k) => corners.reduce((sum, p) => sum + p[k] / 3, 0));

// The names of many triangles: a number in the middle of each, and coordinates at its vertices. Triangles that the lane
// calls intersecting come first, then the triangles nearest to the reference.
function names_of(field: Field, reference: Vec[], shows: Model['shows'], place: (p: readonly number[]) => Vec) {
  const from = middle_of(reference);
  const named = field.triangles.map((triangle, i) => {
    const corners = corners_of(triangle),
      middle = middle_of(corners);
    return { corners, middle, i, away: field.hit[i] ? 0 : Math.hypot(...middle.map((c, k) => c - from[k])) };
  });
  return named
    .sort((s, t) => s.away - t.away)
    .map(({ corners, middle, i }) => [
      ...(shows.ids ? [{ p: place(middle), name: String(field.ids[i]) }] : []),
      ...(shows.coordinates ? corners.map((p) => ({ p: place(p), name: `(${p.map(figure).join(', ')})` })) : []),
    ]);
}

// magnified: the magnification relative to a drawing that fits the board.
export function placed(model: Model, drawing: Drawing, magnified: number, field: Field | null): Placed {
  const { pair, centre, shows } = model,
    points = [0, 1, 2, 3, 4, 5].map((v) => vertex(pair, v));
  const all = field ? [...points, ...field.triangles.flatMap(corners_of)] : points;
  const low = [0, 1, 2].map((k) => all.reduce((least, p) => Math.min(least, p[k]), Infinity)),
    high = [0, 1, 2].map((k) => all.reduce((most, p) => Math.max(most, p[k]), -Infinity));
  const size = drawn_sizes(low, high, pair),
    unit = size.map((s) => s / 2 / magnified) as Vec;
  const { contact, witness } = drawing,
    common = contact.length ? contact : witness;
  const middle = (
    centre === 'the chosen vertex'
      ? vertex(pair, model.vertex / 3)
      : centre === 'the contact or gap' && common.length
        ? [0, 1, 2].map((k) => common.reduce((sum, p) => sum + p[k] / common.length, 0))
        : low.map((l, k) => l / 2 + high[k] / 2)
  ) as Vec;
  const place = (p: readonly number[]) => [0, 1, 2].map((k) => (p[k] - middle[k]) / unit[k]) as Vec;
  const marks: Mark[] = [];
  const [a, b] = [points.slice(0, 3).map(place), points.slice(3).map(place)];
  // The radius of a sphere that contains everything, before magnification.
  const radius =
    Math.max(
      0.6,
      all.reduce(
        (most, p) =>
          Math.max(most, Math.hypot(...p.map((c, k) => (c - (low[k] / 2 + high[k] / 2)) / unit[k] / magnified))),
        0,
      ),
    ) * 0.95;
  if (shows.planes) {
    (field ? [a] : [a, b]).forEach((corners, i) =>
      marks.push({ colour: i ? '--triangle-b' : '--triangle-a', triangles: fan(cut(plane(corners))), opacity: 0.18 }),
    );
  }
  if (!field)
    drawing.sections.forEach(
      (ends, i) =>
        ends.length === 2 &&
        marks.push({
          colour: i ? '--triangle-b-edge' : '--triangle-a-edge',
          lines: [cut(ends.map(place))],
          width: i ? 3 : 7,
        }),
    );
  if (!field && witness.length) marks.push({ colour: '--witness', lines: [cut(witness.map(place))], width: 3 });
  if (!field && model.lane.startsWith('projected_sat/')) {
    const shadow = shadow_of(points).map(place);
    if (shadow.length)
      marks.push({ colour: '--triangle-b-edge', lines: [cut(shadow.concat([shadow[0]]))], width: 1.5, dashed: true });
  }
  if (shows.axes) {
    for (let k = 0; k < 3; ++k) {
      const end = [0, 0, 0],
        origin = [0, 0, 0];
      end[k] = Math.max(...size) / 2;
      marks.push({ colour: `--series-${k}`, lines: [cut([place(origin), place(end)])], width: 2 });
    }
  }
  // Marks the values up to 8 ulps from the chosen coordinate, if the distances between them are visible.
  const chosen = pair[model.chosen],
    at = points[model.vertex / 3],
    axis = model.chosen % 3;
  const moved = (ulps: number) => place(at.map((c, k) => (k === axis ? model.graze.nudged(chosen, ulps) : c)));
  if (Number.isFinite(chosen) && Math.abs(moved(1)[axis] - moved(0)[axis]) > 0.02) {
    const steps = Array.from({ length: 17 }, (_, i) => moved(i - 8)),
      across = (axis + 1) % 3;
    const tick = (p: Vec, by: number) => p.map((c, k) => (k === across ? c + by : c)) as Vec;
    marks.push({
      colour: '--soft',
      lines: [cut([steps[0], steps[16]]), ...steps.map((p) => cut([tick(p, -0.02), tick(p, 0.02)]))],
      width: 1.3,
    });
  }
  if (field) {
    for (const [colour, hit] of [
      ['--other', false],
      ['--series-0', true],
    ] as const)
      marks.push({
        colour,
        triangles: field.triangles.flatMap((t, i) => (field.hit[i] === hit ? corners_of(t).map(place) : [])),
      });
    marks.push({
      colour: '--bad',
      width: 3,
      lines: field.triangles.flatMap((t, i) => (field.wrong[i] ? [[...corners_of(t), vertex(t, 0)].map(place)] : [])),
    });
  }
  return {
    unit,
    middle,
    shape: {
      a: cut(a),
      b: field ? [] : cut(b),
      contact: field ? [] : cut(contact.map(place)),
      line: field ? [] : cut(drawing.line.map(place)),
      radius,
      marks,
      note: `${magnified > 1 ? `× ${figure(magnified)}, ` : ''}${scale_note(size)}`,
      names:
        shows.ids || shows.coordinates
          ? [...a, ...(field ? [] : b)].map((p, i) => ({
              p,
              name: `${shows.ids ? `${i < 3 ? 'a' : 'b'}${i % 3}` : ''}${shows.coordinates ? ` (${points[i].map((x) => decimal(x, model.graze.coordinates)).join(', ')})` : ''}`,
            }))
          : [],
      many_names: field && (shows.ids || shows.coordinates) ? names_of(field, points.slice(0, 3), shows, place) : [],
    },
  };
}
