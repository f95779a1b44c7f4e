// SPDX-License-Identifier: Apache-2.0
// Computes ulp maps in a worker, from coarse to fine.
import type { Coordinates } from './data';
import { load, type Graze } from './graze.js';

export interface MapRequest {
  number: number;
  pair: Coordinates;
  x: number;
  y: number;
  step: number;
  lanes: string[];
  policy: string;
}
export interface MapPart {
  number: number;
  row: number;
  every: number;
  rows: (Uint8Array | null)[];
  milliseconds: number;
  last: boolean;
}
export const kSide = 256;
const kLevels = [16, 4, 1]; // block sizes in columns and rows
const kSlice = 12; // milliseconds after which a newer request is served

let wanted: MapRequest | null = null;
let graze: Graze | undefined;
const ready = new Promise<void>((resolve) => {
  onmessage = async ({ data }: MessageEvent<WebAssembly.Module | MapRequest>) => {
    if (data instanceof WebAssembly.Module) {
      graze = await load(data);
      resolve();
    } else {
      const idle = wanted === null;
      wanted = data;
      if (idle) draw();
    }
  };
});

async function draw() {
  await ready;
  while (wanted) {
    const request: MapRequest = wanted,
      { number, pair, x, y, step, lanes, policy } = request,
      start = performance.now();
    let pause = start;
    graze!.set_policy(policy);
    for (const every of kLevels) {
      for (let row = 0; row < kSide; row += every) {
        const up = (kSide / 2 - row) * step,
          rows = graze!.map_row(pair, x, y, up, kSide / every, every * step, lanes),
          last = every === 1 && row === kSide - 1,
          milliseconds = performance.now() - start;
        postMessage({ number, row, every, rows, milliseconds, last } satisfies MapPart);
        if (performance.now() - pause > kSlice) {
          await new Promise((resolve) => setTimeout(resolve, 0));
          pause = performance.now();
        }
        if (wanted !== request) break;
      }
      if (wanted !== request) break;
    }
    if (wanted === request) wanted = null;
  }
}
