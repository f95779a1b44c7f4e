// SPDX-License-Identifier: Apache-2.0
// Tests triangles exactly in Node.   Usage: node example.mjs [graze.wasm]
import { readFileSync } from 'node:fs';
import { load } from './graze.js';

const graze = await load(readFileSync(process.argv[2] ?? new URL('graze.wasm', import.meta.url)));

const floor = [0, 0, 0, 4, 0, 0, 0, 4, 0];
const standing = (/** @type {number} */ height) => [...floor, 1, 1, height, 1, 2, 4, 2, 1, 4];
for (const [name, pair] of /** @type {const} */ ([
  ['touching', standing(0)],
  ['a quarter above', standing(0.25)],
])) {
  const { verdict, contact } = graze.truth(pair);
  const { least, most } = graze.margin(pair);
  console.log(`${name}: ${verdict}, contact ${contact}, margin ${least.toPrecision(3)} to ${most.toPrecision(3)}`);
}

const shared = [0.1, 0.2, 0.3, 0.4, 0.9, 0.2, 0.7, 0.1, 0.6, 0.1, 0.2, 0.3, 0.5, 0.5, 0.9, -0.3, 0.8, 0.4];
const verdicts = graze.decide(shared);
console.log(`two triangles with one vertex in common: ${graze.truth(shared).verdict}`);
for (const lane of ['cpu', 'cuda-nofma', 'cuda-fma'])
  console.log(`  guigue_devillers_2003/f64/${lane}: ${verdicts[`guigue_devillers_2003/f64/${lane}`]}`);
