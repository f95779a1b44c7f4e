// SPDX-License-Identifier: Apache-2.0
// graze-wasm in Node. Reads the module from the file beside this one.
import { readFile } from 'node:fs/promises';
import { packaged } from './packaged.js';

export const { ready, testOverlap } = packaged(() => readFile(new URL('graze.wasm', import.meta.url)));
export { load } from './graze.js';
