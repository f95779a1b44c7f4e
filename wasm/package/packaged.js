// SPDX-License-Identifier: Apache-2.0
// The functions that the package exports. They need a function that reads graze.wasm.
import { load } from './graze.js';
import { expect_right } from './test_function.js';

/** @typedef {import('./graze.js').Graze} Graze */
/** @typedef {import('./test_function.js').Overlap} Overlap */
/** @typedef {import('./test_function.js').TestOptions} TestOptions */
/** @typedef {import('./test_function.js').TestResult} TestResult */

/** @param {() => Promise<BufferSource>} read */
export function packaged(read) {
  /** @type {Promise<Graze> | undefined} */
  let loaded;

  /** The module's functions; the module is loaded once. @returns {Promise<Graze>} */
  const ready = () => (loaded ??= read().then(load));

  /**
   * Tests a function of two triangles on pairs that nearly touch, are degenerate or are coplanar. If the share of wrong
   * answers is above max_wrong, the promise rejects with the counts and the smallest wrong pair.
   * @param {Overlap} overlap @param {TestOptions} [options] @returns {Promise<TestResult>}
   */
  const testOverlap = async (overlap, options) => expect_right(await ready(), overlap, options);

  return { ready, testOverlap };
}
