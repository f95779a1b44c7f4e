// SPDX-License-Identifier: Apache-2.0
// graze-wasm in Node. The module is a file beside this file.
import { readFile } from 'node:fs/promises';
import { packaged } from './packaged.js';

export const { ready, testOverlap } = packaged(() => readFile(new URL('graze.wasm', import.meta.url)));
export { load } from './graze.js';
