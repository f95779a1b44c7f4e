// SPDX-License-Identifier: Apache-2.0
// The camera of a drawing. Dragging turns the camera about the centre with three.js's OrbitControls. Keys and buttons
// set a view.
import { MathUtils, OrthographicCamera } from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import type { View } from './drawing';

const kSteepest = 1e-3; // least angle in radians from straight above or below, where left and right are undefined
const kFar = 1e4; // parts outside the frame may be far in front of the framed part

export function view_of({ position, zoom }: OrthographicCamera): View {
  return { azimuth: Math.atan2(position.y, position.x), elevation: Math.asin(position.z / position.length()), zoom };
}

export interface Orbit {
  camera: OrthographicCamera;
  set: (view: Partial<View>) => void;
}

// Calls `turned` after each move of the camera, and `rested` at the end of a drag.
export function orbit(board: HTMLElement, view: View, turned: () => void, rested: () => void): Orbit {
  const camera = new OrthographicCamera();
  camera.up.set(0, 0, 1);
  camera.near = 0.1;
  camera.far = 2 * kFar;
  camera.position.setScalar(kFar);
  const controls = new OrbitControls(camera, board);
  board.style.touchAction = ''; // vertical swipes scroll the page
  Object.assign(controls, {
    enablePan: false,
    enableZoom: false,
    rotateSpeed: 0.6,
    minPolarAngle: kSteepest,
    maxPolarAngle: Math.PI - kSteepest,
  });
  controls.addEventListener('end', rested);

  function set(next: Partial<View>) {
    const { azimuth, elevation, zoom } = { ...view_of(camera), ...next };
    const steep = MathUtils.clamp(elevation, kSteepest - Math.PI / 2, Math.PI / 2 - kSteepest);
    camera.position
      .set(Math.cos(steep) * Math.cos(azimuth), Math.cos(steep) * Math.sin(azimuth), Math.sin(steep))
      .multiplyScalar(kFar);
    camera.zoom = MathUtils.clamp(zoom, 0.25, 64);
    if (!controls.update()) turned(); // update() returns true if its change event already called `turned`
  }

  set(view);
  controls.addEventListener('change', turned);
  return { camera, set };
}
