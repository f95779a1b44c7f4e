// SPDX-License-Identifier: Apache-2.0
// graze-wasm in browsers. Bundlers find the module through the URL in this file.
import { packaged } from './packaged.js';

/** @typedef {import('./graze.js').Graze} Graze */
/** @typedef {import('./test_function.js').Overlap} Overlap */
/** @typedef {import('./test_function.js').TestOptions} TestOptions */
/** @typedef {import('./test_function.js').TestResult} TestResult */

export const { ready, testOverlap } = packaged(async () => {
  const url = new URL('graze.wasm', import.meta.url);
  const response = await fetch(url);
  if (!response.ok) throw new Error(`cannot load ${url}: ${response.status} ${response.statusText}`);
  return response.arrayBuffer();
});
export { load } from './graze.js';
