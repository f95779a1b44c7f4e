// SPDX-License-Identifier: Apache-2.0
// Tests a function of two triangles on pairs of the strata, as <graze/test.h> does for C++.

/**
 * A function that returns whether two triangles, each of 9 coordinates, intersect. A number below 0 declines.
 * @typedef {(a: Float32Array, b: Float32Array) => boolean | number} Overlap
 */
/**
 * A kind of pairs: pairs that only touch, lie in one plane, have a segment or a point instead of a triangle, or share
 * a vertex.
 * @typedef {'touching' | 'coplanar' | 'degenerate' | 'shared'} Kind
 */
/**
 * @typedef {object} TestOptions
 * @property {string} [name] the function's name in the message; default: its own
 * @property {string | string[]} [strata] names with * and ?, separated by commas; "!x" leaves out x; default: "*"
 * @property {number} [pairs] the number of pairs, divided equally among the strata; default: 100,000
 * @property {number} [seed] the seed of the pairs; default: 1
 * @property {number} [max_wrong] the accepted share of wrong answers; default: 0
 * @property {Kind | Kind[]} [either] kinds of pairs on which both answers are accepted; default: none
 */
/**
 * @typedef {object} TestResult
 * @property {boolean} passed
 * @property {string} summary the numbers of wrong answers, by stratum; empty if the test passed
 * @property {string} fault the error in the answer on the smallest pair
 * @property {number} pairs
 * @property {number} wrong
 * @property {number} declined
 * @property {{ a: number[], b: number[] } | null} smallest a wrong pair, shrunk without changing truth or answer
 * @property {unknown} thrown the first error that the function threw; each throw is a wrong answer; null: none
 */

/** @type {readonly Kind[]} */
const kKinds = ['touching', 'coplanar', 'degenerate', 'shared'];
const kOptions = ['name', 'strata', 'pairs', 'seed', 'max_wrong', 'either'];
const kDeclined = 2,
  kThrown = 3;

/** Whether a stratum's name matches the pattern. @param {string} pattern @param {string} name */
function matches(pattern, name) {
  const expression = pattern.replace(/\W/g, (c) => ({ '*': '.*', '?': '.' })[c] ?? `\\${c}`);
  return new RegExp(`^${expression}$`).test(name);
}

/** @param {readonly string[]} strata @param {string} wanted */
function expect_strata(strata, wanted) {
  const patterns = wanted.split(',');
  for (const pattern of patterns)
    if (!strata.some((id) => matches(pattern.replace(/^!/, ''), id)))
      throw new RangeError(`strata: none matches '${pattern}'; there are ${strata.join(', ')}`);
  const [taken, left_out] = [false, true].map((out) => patterns.filter((pattern) => pattern.startsWith('!') === out));
  const leaves = strata.some(
    (id) =>
      (taken.length === 0 || taken.some((pattern) => matches(pattern, id))) &&
      !left_out.some((pattern) => matches(pattern.slice(1), id)),
  );
  if (!leaves) throw new RangeError(`strata: '${wanted}' leaves none`);
}

/** @param {string} what @param {number} count */
function whole(what, count) {
  if (!Number.isSafeInteger(count) || count < 0)
    throw new RangeError(`${what}: expected a whole number, found ${typeof count} ${count}`);
  return BigInt(count);
}

/** @param {Overlap} overlap @param {TestOptions} options */
function expect_function_and_options(overlap, options) {
  if (typeof overlap !== 'function')
    throw new TypeError(`expected a function of two triangles, found ${overlap === null ? 'null' : typeof overlap}`);
  if (typeof options !== 'object' || options === null)
    throw new TypeError(`options: expected an object such as { pairs: 1000 }, found ${options}`);
  for (const option of Object.keys(options))
    if (!kOptions.includes(option))
      throw new TypeError(`there is no option '${option}'; there are ${kOptions.join(', ')}`);
}

/**
 * Draws pairs from the strata, calls the function, and compares its answers with the exact answers. Then it shrinks the
 * simplest wrong pair, with at most 50,000 calls, without changing the true relation or the wrong answer.
 * Throws: RangeError for an option that is not valid, TypeError for an answer that is neither boolean nor number.
 * @param {import('./graze.js').Graze} graze @param {Overlap} overlap
 * @param {TestOptions} [options] @returns {TestResult}
 */
export function test_function(graze, overlap, options = {}) {
  expect_function_and_options(overlap, options);
  const { pairs = 100_000, seed = 1, max_wrong = 0 } = options;
  const strata = [options.strata ?? '*'].flat().join(',');
  const either = [options.either ?? []].flat();
  const name = (options.name ?? overlap.name) || 'the function';
  const { exports, host } = graze;
  expect_strata(graze.strata, strata);
  if (!(max_wrong >= 0 && max_wrong <= 1)) throw new RangeError(`max_wrong: expected 0 to 1, found ${max_wrong}`);
  let kinds = 0;
  for (const kind of either) {
    if (!kKinds.includes(kind)) throw new RangeError(`either: '${kind}' is none of ${kKinds.join(', ')}`);
    kinds |= 1 << kKinds.indexOf(kind);
  }

  /** @type {unknown} */
  let thrown = null;
  /** @type {TypeError | null} */
  let no_answer = null; // thrown after the module has returned, because the module does not unwind its stack
  /** @param {Float32Array} a @param {Float32Array} b */
  function verdict(a, b) {
    if (no_answer) return kDeclined;
    let answer;
    try {
      answer = overlap(a, b);
    } catch (error) {
      thrown ??= error;
      return kThrown;
    }
    if (typeof answer !== 'boolean' && !(typeof answer === 'number' && !Number.isNaN(answer))) {
      no_answer = new TypeError(`${name} returns ${answer}; expected true, false, or a number below 0 for declined`);
      return kDeclined;
    }
    return Number(answer) < 0 ? kDeclined : Number(Boolean(answer));
  }

  host.decide = (at, count, verdicts) => {
    const numbers = new Float32Array(exports.memory.buffer, at, 18 * count).slice();
    const said = Uint8Array.from({ length: count }, (_, i) =>
      verdict(numbers.slice(18 * i, 18 * i + 9), numbers.slice(18 * i + 9, 18 * i + 18)),
    );
    new Uint8Array(exports.memory.buffer, verdicts, count).set(said);
  };
  graze.set_text(`${name.replaceAll('\0', ' ')}\0${strata}`);
  const out = exports.test_function(whole('pairs', pairs), whole('seed', seed), max_wrong, kinds);
  if (no_answer) throw no_answer;

  const [passed, has_smallest, summary, fault] = new Int32Array(exports.memory.buffer, out, 4);
  const [tested, positive, negative, declined, failed] = new Float64Array(exports.memory.buffer, out + 16, 5);
  const coordinates = [...new Float32Array(exports.memory.buffer, out + 64, 18)];
  return {
    passed: passed !== 0,
    summary: graze.text_at(summary),
    fault: graze.text_at(fault),
    pairs: tested,
    wrong: positive + negative + failed,
    declined,
    smallest: has_smallest ? { a: coordinates.slice(0, 9), b: coordinates.slice(9) } : null,
    thrown,
  };
}

/**
 * The number in a Node environment variable; `otherwise` if the variable is not set.
 * @param {string} variable @param {number | undefined} otherwise
 */
function of_environment(variable, otherwise) {
  const text = /** @type {any} */ (globalThis).process?.env?.[variable];
  if (!text) return otherwise;
  if (!/^\d{1,15}$/.test(text)) throw new RangeError(`${variable}: expected a whole number, found '${text}'`);
  return Number(text);
}

/** @param {number[]} nine */
const list = (nine) => `[${nine.map((x) => (Object.is(x, -0) ? '-0' : String(x))).join(', ')}]`;

/**
 * Throws an error with the counts and the smallest wrong pair if the share of wrong answers is above max_wrong. In Node,
 * the environment variables GRAZE_PAIRS and GRAZE_SEED override the options' numbers.
 * @param {import('./graze.js').Graze} graze @param {Overlap} overlap
 * @param {TestOptions} [options] @returns {TestResult}
 */
export function expect_right(graze, overlap, options = {}) {
  expect_function_and_options(overlap, options);
  const { pairs, seed } = options;
  const result = test_function(graze, overlap, {
    ...options,
    pairs: of_environment('GRAZE_PAIRS', pairs),
    seed: of_environment('GRAZE_SEED', seed),
  });
  if (result.passed) return result;
  const { smallest } = result;
  const pair = smallest
    ? `  const a = ${list(smallest.a)},\n    b = ${list(smallest.b)}; // right: ${graze.intersects(smallest.a, smallest.b)}\n`
    : '';
  const words = smallest ? `The smallest wrong pair that was found: ${result.fault}.\n` : '';
  const first = result.thrown === null ? '' : `It first threw: ${result.thrown}\n`;
  throw new Error(result.summary + words + pair + first, result.thrown === null ? undefined : { cause: result.thrown });
}
