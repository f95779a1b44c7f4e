// SPDX-License-Identifier: Apache-2.0
// Finds the pairs of triangles of two three.js geometries that meet, with exact tests. Apply a mesh's matrix first:
// geometry.clone().applyMatrix4(mesh.matrixWorld).
import { ready } from 'graze-wasm';

/**
 * The triangles of a geometry, nine coordinates each.
 * @param {{ attributes: Record<string, any>, index: { count: number, getX(i: number): number } | null }} geometry
 */
export function triangles_of({ attributes, index }) {
  const { position } = attributes;
  const count = index ? index.count : position.count;
  return Array.from({ length: Math.floor(count / 3) }, (_, t) =>
    [0, 1, 2].flatMap((k) => {
      const vertex = index ? index.getX(3 * t + k) : 3 * t + k;
      return [position.getX(vertex), position.getY(vertex), position.getZ(vertex)];
    }),
  );
}

/** @param {number[]} t @param {number} axis */
const range_of = (t, axis) => [
  Math.min(t[axis], t[axis + 3], t[axis + 6]),
  Math.max(t[axis], t[axis + 3], t[axis + 6]),
];

/** @param {number[]} a @param {number[]} b */
const boxes_meet = (a, b) =>
  [0, 1, 2].every((axis) => {
    const [low, high] = range_of(a, axis),
      [from, to] = range_of(b, axis);
    return low <= to && from <= high;
  });

/**
 * The pairs [i, j] of triangles that meet; i is in the first geometry, j in the second.
 * @param {Parameters<typeof triangles_of>[0]} first @param {Parameters<typeof triangles_of>[0]} second
 */
export async function meeting(first, second) {
  const graze = await ready();
  const others = triangles_of(second);
  return triangles_of(first).flatMap((a, i) =>
    others.flatMap((b, j) => (boxes_meet(a, b) && graze.intersects(a, b) ? [[i, j]] : [])),
  );
}
