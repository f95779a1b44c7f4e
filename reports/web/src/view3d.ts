// SPDX-License-Identifier: Apache-2.0
// Draws with WebGL. All cards share one renderer, because a browser allows only about 16 contexts. The renderer draws
// off screen, and each card copies its picture to its own canvas.
import {
  AmbientLight,
  BufferGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  Float32BufferAttribute,
  Material,
  Mesh,
  MeshLambertMaterial,
  MeshBasicMaterial,
  type OrthographicCamera,
  Scene,
  WebGLRenderer,
} from 'three';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';
import { LineSegments2 } from 'three/examples/jsm/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/examples/jsm/lines/LineSegmentsGeometry.js';
import { view_of } from './camera';
import { fan, framed_half_height, labels, project, type Shape, type Vec, type View } from './drawing';

let renderer: WebGLRenderer | null | undefined; // null: this browser has no WebGL

function shared_renderer(): WebGLRenderer | null {
  if (renderer !== undefined) return renderer;
  const canvas = document.createElement('canvas');
  if (!canvas.getContext('webgl2', { alpha: true, antialias: true })) return (renderer = null);
  renderer = new WebGLRenderer({ canvas, alpha: true, antialias: true });
  canvas.addEventListener('webglcontextlost', () => (renderer = null));
  return renderer;
}

export const has_webgl = () => shared_renderer() !== null;

export interface Picture {
  draw: (canvas: HTMLCanvasElement, camera: OrthographicCamera) => void;
  dispose: () => void;
}

const style_colour = (name: string) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

const closed = (points: Vec[]) => [...points, points[0]];

export function picture(shape: Shape): Picture {
  const scene = new Scene();
  const light = new DirectionalLight(0xffffff, 1.9);
  scene.add(new AmbientLight(0xffffff, 1.5), light);
  const coloured: { material: Material & { color: Color }; name: string }[] = [];
  const lines: { material: LineMaterial; width: number }[] = [];
  const made: { dispose: () => void }[] = [];

  // Triangles, three corners each.
  function add_mesh(corners: Vec[], name: string, material: Material & { color: Color }) {
    const geometry = new BufferGeometry().setAttribute('position', new Float32BufferAttribute(corners.flat(), 3));
    geometry.computeVertexNormals();
    const mesh = new Mesh(geometry, material);
    scene.add(mesh);
    coloured.push({ material, name });
    made.push(geometry, material);
    return mesh;
  }

  function add_lines(polylines: Vec[][], name: string, width: number, hidden: 'shown' | 'faint', dashed = false) {
    const material = new LineMaterial({ linewidth: width, dashed, dashSize: 0.06, gapSize: 0.04, transparent: true });
    const geometry = new LineSegmentsGeometry().setPositions(
      polylines.flatMap((points) => points.slice(1).flatMap((q, i) => [...points[i], ...q])),
    );
    if (hidden === 'faint') Object.assign(material, { depthTest: false, opacity: 0.35 });
    coloured.push({ material, name });
    lines.push({ material, width });
    const line = new LineSegments2(geometry, material);
    if (dashed) line.computeLineDistances();
    scene.add(line);
    made.push(geometry, material);
    return line;
  }

  for (const [name, points, shift] of [
    ['--triangle-a', shape.a, 1],
    ['--triangle-b', shape.b, 2],
  ] as const) {
    // The offset keeps edges in front of faces, and prevents coplanar faces from flickering.
    const material = new MeshLambertMaterial({
      side: DoubleSide,
      polygonOffset: true,
      polygonOffsetFactor: shift,
      polygonOffsetUnits: 2 * shift,
    });
    add_mesh(fan(points), name, material);
    add_lines([closed(points)], `${name}-edge`, 2, 'shown');
    add_lines([closed(points)], `${name}-edge`, 1.2, 'faint').renderOrder = 1; // drawn even where the other triangle hides it
  }
  for (const { colour, triangles, opacity, lines, width, dashed } of shape.marks ?? []) {
    if (triangles?.length) {
      const solid = opacity === undefined;
      const material = new MeshLambertMaterial({
        side: DoubleSide,
        transparent: !solid,
        opacity: opacity ?? 1,
        depthWrite: solid,
        polygonOffset: true,
        polygonOffsetFactor: 3,
        polygonOffsetUnits: 6,
      });
      add_mesh(triangles, colour, material);
    }
    const drawn = (lines ?? []).filter((points) => points.length > 1);
    if (drawn.length) add_lines(drawn, colour, width ?? 1.5, 'shown', dashed);
  }
  if (shape.line.length > 1) add_lines([shape.line], '--ink', 1.3, 'shown', true);
  if (shape.contact.length > 2) {
    const material = new MeshBasicMaterial({ side: DoubleSide, depthTest: false, transparent: true, opacity: 0.55 });
    add_mesh(fan(shape.contact), '--contact', material).renderOrder = 2;
  }
  if (shape.contact.length > 1) {
    const edges = shape.contact.length > 2 ? closed(shape.contact) : shape.contact;
    const line = add_lines([edges], '--contact', 4, 'shown');
    line.material.depthTest = false;
    line.renderOrder = 3;
  }

  function draw(canvas: HTMLCanvasElement, camera: OrthographicCamera) {
    const gl = shared_renderer();
    const context = canvas.getContext('2d');
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!gl || !context || !width || !height) return;
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    gl.setPixelRatio(1);
    if (gl.domElement.width !== canvas.width || gl.domElement.height !== canvas.height)
      gl.setSize(canvas.width, canvas.height, false);
    for (const { material, name } of coloured) material.color.set(style_colour(name));
    for (const line of lines) line.material.linewidth = line.width * ratio;
    const half = framed_half_height(shape);
    Object.assign(camera, { left: (-half * width) / height, right: (half * width) / height, top: half, bottom: -half });
    camera.updateProjectionMatrix();
    light.position.copy(camera.position);
    gl.setClearColor(0, 0);
    gl.render(scene, camera);
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.drawImage(gl.domElement, 0, 0);
    overlay(context, view_of(camera), width, height, ratio);
  }

  // Draws the names of the vertices, and the contact if it is a point.
  function overlay(context: CanvasRenderingContext2D, view: View, width: number, height: number, ratio: number) {
    context.save();
    context.scale(ratio, ratio);
    if (shape.contact.length === 1) {
      const { x, y } = project(shape, shape.contact[0], view, width, height);
      context.beginPath();
      context.arc(x, y, 5, 0, 2 * Math.PI);
      context.fillStyle = style_colour('--contact');
      context.strokeStyle = style_colour('--page');
      context.lineWidth = 2;
      context.fill();
      context.stroke();
    }
    context.font = '12px ui-monospace, monospace';
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.fillStyle = style_colour('--ink');
    context.strokeStyle = style_colour('--raised'); // an outline, which keeps names readable in front of lines
    context.lineWidth = 3;
    context.lineJoin = 'round';
    for (const { x, y, text } of labels(shape, view, width, height)) {
      context.strokeText(text, x, y);
      context.fillText(text, x, y);
    }
    context.restore();
  }

  return { draw, dispose: () => made.forEach((one) => one.dispose()) };
}
