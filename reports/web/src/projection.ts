// SPDX-License-Identifier: Apache-2.0
// Draws a pair as SVG, for print and for browsers without WebGL.
import { labels, project, type Shape, type Vec, type View } from './drawing';

const kMostTriangles = 500; // in one mark; drawing more would take a browser seconds
const kSvg = 'http://www.w3.org/2000/svg';

export function node(name: string, attributes: Record<string, string | number>, text = '') {
  const element = document.createElementNS(kSvg, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  element.textContent = text;
  return element;
}

export function svg_projection(shape: Shape, view: View, width: number, height: number): SVGSVGElement {
  const at = (p: Vec) => project(shape, p, view, width, height);
  const path = (points: Vec[]) =>
    points
      .map((p) => {
        const { x, y } = at(p);
        return `${x.toFixed(1)},${y.toFixed(1)}`;
      })
      .join(' ');
  const depth = (points: Vec[]) => points.reduce((sum, p) => sum + at(p).depth, 0);
  const svg = node('svg', { viewBox: `0 0 ${width} ${height}`, 'aria-hidden': 'true' }) as SVGSVGElement;
  for (const { colour, triangles, opacity, lines, width, dashed } of shape.marks ?? []) {
    for (let i = 0; i + 2 < Math.min(triangles?.length ?? 0, 3 * kMostTriangles); i += 3)
      svg.append(
        node('polygon', {
          points: path(triangles!.slice(i, i + 3)),
          style: `fill: var(${colour}); fill-opacity: ${opacity ?? 0.8}`,
        }),
      );
    for (const points of (lines ?? []).slice(0, kMostTriangles))
      svg.append(
        node('polyline', {
          points: path(points),
          style: `stroke: var(${colour}); fill: none; stroke-width: ${width ?? 1.5}${dashed ? '; stroke-dasharray: 6 4' : ''}`,
        }),
      );
  }
  if (shape.line.length) svg.append(node('polyline', { points: path(shape.line), class: 'planes-line' }));
  const triangles = [
    { points: shape.a, name: 'a' },
    { points: shape.b, name: 'b' },
  ].sort((s, t) => depth(s.points) - depth(t.points));
  for (const { points, name } of triangles) {
    svg.append(node('polygon', { points: path(points), class: `triangle-${name}` }));
    for (const p of points) svg.append(node('circle', { cx: at(p).x, cy: at(p).y, r: 2.5, class: `vertex-${name}` }));
  }
  if (shape.contact.length === 1) {
    const { x, y } = at(shape.contact[0]);
    svg.append(node('circle', { cx: x, cy: y, r: 5, class: 'contact' }));
  } else if (shape.contact.length) svg.append(node('polygon', { points: path(shape.contact), class: 'contact' }));
  for (const { x, y, text } of labels(shape, view, width, height))
    svg.append(node('text', { x, y, class: 'vertex-name' }, text));
  return svg;
}
