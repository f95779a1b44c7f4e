// SPDX-License-Identifier: Apache-2.0
// Prepares a pair to be drawn: fits it into a box of half-width 1, and projects it along a direction. Both steps
// are affine, so they preserve straight lines and contacts. Uses doubles, because a float32 card has coordinates from
// 2^-149 to 2^128, and a card of doubles a larger range.
import { figure } from './format';
import type { Report } from './report';

export type Vec = [number, number, number];
export type Frame = 'both' | 'a' | 'b';
export interface Shape {
  a: Vec[];
  b: Vec[];
  contact: Vec[];
  line: Vec[];
  radius: number;
  note: string;
  marks?: Mark[];
  names?: Name[];
  many_names?: Name[][]; // the names of each triangle of a field, the nearest triangle first
}
export interface Name {
  p: Vec;
  name: string;
}
// Triangles (three corners each) or polylines of a given width, in a colour of the style sheet.
export interface Mark {
  colour: string;
  triangles?: Vec[];
  opacity?: number;
  lines?: Vec[][];
  width?: number;
  dashed?: boolean;
}
export interface View {
  azimuth: number;
  elevation: number;
  zoom: number;
}

const kLongestToScale = 12; // if extents differ by more than this factor, all axes are stretched to the same length

// Returns, for each axis, the extent that fills the drawing: the longest extent of all axes, or, if the extents differ
// much, the axis's own extent.
export function drawn_sizes(low: number[], high: number[], value: ArrayLike<number>): Vec {
  const extent = low.map((l, k) => high[k] - l);
  const longest = Math.max(...extent) || Math.max(...Array.from(value, Math.abs)) || 1;
  const stretch = extent.some((e) => e > 0 && longest / e > kLongestToScale);
  return extent.map((e) => (stretch && e > 0 ? e : longest)) as Vec;
}

export function scale_note(sizes: Vec) {
  const longest = Math.max(...sizes);
  const factors = ['x', 'y', 'z'].flatMap((axis, k) =>
    sizes[k] < 0.99 * longest ? [`${axis} × ${figure(longest / sizes[k])}`] : [],
  );
  return factors.length ? `not to scale: ${factors.join(', ')}` : 'to scale';
}

export function shape_of(card: Report['cards'][number], frame: Frame): Shape {
  const { value } = card.pair;
  const points = Array.from({ length: 6 }, (_, i) => value.slice(3 * i, 3 * i + 3) as Vec);
  const framed = frame === 'a' ? points.slice(0, 3) : frame === 'b' ? points.slice(3) : points;
  const low = [0, 1, 2].map((k) => Math.min(...framed.map((p) => p[k])));
  const high = [0, 1, 2].map((k) => Math.max(...framed.map((p) => p[k])));
  const size = drawn_sizes(low, high, value);
  const place = (p: readonly number[]) =>
    [0, 1, 2].map((k) => (p[k] - (low[k] / 2 + high[k] / 2)) / (size[k] / 2)) as Vec;
  return {
    a: points.slice(0, 3).map(place),
    b: points.slice(3).map(place),
    contact: card.drawing.contact.map(place),
    line: card.drawing.planes_line.map(place),
    radius: (frame === 'both' ? 1 : 1.5) * Math.max(0.5, ...framed.map((p) => Math.hypot(...place(p)))), // the other triangle stays visible
    note: scale_note(size),
  };
}

export const dot = (p: Vec, q: Vec) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
export const minus = (p: Vec, q: Vec): Vec => [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
export const cross = (u: Vec, v: Vec): Vec => [
  u[1] * v[2] - u[2] * v[1],
  u[2] * v[0] - u[0] * v[2],
  u[0] * v[1] - u[1] * v[0],
];

// The triangles of a convex polygon, three corners each.
export const fan = (points: Vec[]) => points.slice(2).flatMap((q, i) => [points[0], points[i + 1], q]);

function normal([p, q, r]: Vec[]): Vec {
  const n = cross(minus(q, p), minus(r, p));
  const length = Math.hypot(...n);
  return length > 0 ? (n.map((c) => c / length) as Vec) : [0, 0, 0];
}

// Unit vectors to the right, up, and towards the eye. The z axis points up.
export function axes({ azimuth, elevation }: View): { right: Vec; up: Vec; eye: Vec } {
  const [ca, sa, ce, se] = [Math.cos(azimuth), Math.sin(azimuth), Math.cos(elevation), Math.sin(elevation)];
  return { right: [-sa, ca, 0], up: [-se * ca, -se * sa, ce], eye: [ce * ca, ce * sa, se] };
}

// A direction from which neither triangle appears edge-on.
export function good_view({ a, b }: Shape): View {
  const normals = [normal(a), normal(b)].filter((n) => dot(n, n) > 0);
  let best: View = { azimuth: 0.6, elevation: 0.45, zoom: 1 },
    most = -1;
  for (let i = 0; i < 48; ++i) {
    for (const elevation of [0.3, 0.5, 0.75, 1]) {
      const view = { azimuth: (Math.PI * i) / 24 + 0.05, elevation, zoom: 1 };
      const seen = Math.min(1, ...normals.map((n) => Math.abs(dot(n, axes(view).eye)))) - 0.08 * elevation;
      if (seen > most + 1e-9) [best, most] = [view, seen];
    }
  }
  return best;
}

// The smallest height of a triangle as drawn: 0 if it looks like a segment or a point.
function height([p, q, r]: Vec[]): number {
  const u = minus(q, p),
    v = minus(r, p);
  const area = Math.hypot(...cross(u, v));
  const longest = Math.max(Math.hypot(...u), Math.hypot(...v), Math.hypot(...minus(u, v)));
  return longest > 0 ? area / longest : 0;
}

// Frames both triangles, or only one of them if it would look too small or too thin beside the other.
export function good_frame(card: Report['cards'][number]): Frame {
  const kThin = 0.06;
  const both = shape_of(card, 'both');
  const thin = (['a', 'b'] as const).filter(
    (name) => height(both[name]) < kThin && height(shape_of(card, name)[name]) >= kThin,
  );
  return thin[0] ?? 'both';
}

// Half of the visible height at zoom 1, into which the framed points fit from every direction.
export const framed_half_height = (shape: Shape) => 1.12 * shape.radius;

// The position in pixels of a point on a stage of this width and height.
export function project(
  shape: Shape,
  p: Vec,
  view: View,
  width: number,
  height: number,
): { x: number; y: number; depth: number } {
  const { right, up, eye } = axes(view);
  const scale = ((height / 2) * view.zoom) / framed_half_height(shape);
  return { x: width / 2 + scale * dot(p, right), y: height / 2 - scale * dot(p, up), depth: dot(p, eye) };
}

const kMostNumbers = 30, // triangles with numbers; more would be unreadable
  kMostCoordinates = 10;

// The names of the triangles in view or, if there are too many, of the nearest ones only.
function names_of_many(shape: Shape, view: View, width: number, height: number) {
  const inside = ({ x, y }: { x: number; y: number }) => x > 0 && y > 0 && x < width && y < height;
  const seen = (shape.many_names ?? [])
    .map((names) => names.map(({ p, name }) => ({ ...project(shape, p, view, width, height), text: name })))
    .filter((names) => names.some(inside));
  return seen.slice(0, seen[0]?.length === 1 ? kMostNumbers : kMostCoordinates).flat();
}

// The labels of the drawing. Vertex names lie outside the triangles, and coinciding vertices share one label.
export function labels(shape: Shape, view: View, width: number, height: number) {
  const at = new Map<string, { x: number; y: number; text: string }>();
  const kAway = 14,
    kHalfLetter = 3.6;
  const vertices = shape.names ?? [
    ...shape.a.map((p, i) => ({ p, name: `a${i}` })),
    ...shape.b.map((p, i) => ({ p, name: `b${i}` })),
  ];
  const seen = vertices.map(({ p, name }) => ({ ...project(shape, p, view, width, height), name }));
  const middle = { x: width / 2, y: height / 2 };
  for (const { x, y, name } of seen) {
    const key = `${Math.round(x / 6)} ${Math.round(y / 6)}`;
    const found = at.get(key);
    if (found) found.text += ` ${name}`;
    else at.set(key, { x, y, text: name });
  }
  const of_vertices = [...at.values()]
    .map(({ x, y, text }) => {
      const away = Math.hypot(x - middle.x, y - middle.y) || 1;
      return {
        x: x + ((kAway + kHalfLetter * (text.length - 2)) * (x - middle.x)) / away,
        y: y + (kAway * (y - middle.y)) / away,
        text,
      };
    })
    .filter(({ x, y }) => x > -10 && y > -10 && x < width + 10 && y < height + 10);
  return [...of_vertices, ...names_of_many(shape, view, width, height)];
}
