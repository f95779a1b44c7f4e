// SPDX-License-Identifier: Apache-2.0
// graze.wasm and graze_f64.wasm for JavaScript and TypeScript: exact triangle-triangle intersection, and the verdicts
// of published algorithms on the same pair. The algorithms run in float32 and float64, with the CPU's arithmetic and,
// through their twins, the GPU's. This file has no dependencies. It runs in Node 18 or newer and in browsers since
// 2021.

/** The 18 coordinates of a[0] to a[2], then of b[0] to b[2]. graze.wasm rounds each coordinate to float32; graze_f64.wasm decides the doubles. @typedef {ArrayLike<number>} Pair */
/** @typedef {'disjoint' | 'intersects' | 'declined'} Verdict declined: a coordinate is not finite, or a lane cannot decide. */
/** @typedef {'none' | 'point' | 'segment' | 'area'} Contact */
/** @typedef {{ verdict: Verdict, contact: Contact, coplanar: boolean, dimensions: [number, number] }} Truth dimensions: those of the two hulls; 0: point, 1: segment, 2: triangle. */
/** @typedef {{ sign: -1 | 0 | 1, least: number, most: number, ulp: number }} Margin sign 1: the triangles are disjoint, and the distance is `least` to `most`. -1: they intersect, and the depth is `least` to `most`. 0: they touch. ulp: the ulp of the largest coordinate. */
/** @typedef {[number, number, number]} Point */
/** @typedef {{ contact: Point[], line: Point[], sections: [Point[], Point[]], witness: Point[], along: [number, number][], features: [string, string] }} Drawing line: the line in which the planes meet; sections: the parts of the line in a and in b. witness: the distance that the margin measures, between the nearest points of a and b or along the shortest push of b that separates the triangles; along: the extents of a and b along the witness, with the end of a at 0; features: the features of a and b that the witness joins, or that determine the push's direction. */
/** @typedef {{ line: string, site: string, relation: string, held: boolean, holds: boolean, result: number, left: number, right: number, exactLeft: number, exactRight: number }} Step relation: '' if the step has only a value, left. held: the outcome in the lane; holds: the outcome with 113 bits. result: the index of left among the numbers that the run computed, or -1. */
/** @typedef {{ line: string, from: string }} Site A source line with two operations that are rounded only once, and the place into which it is inlined. */
/** @typedef {{ decide: (pairs: number, count: number, verdicts: number) => void }} Host The function that the module calls. It decides the `count` pairs at the address `pairs` and writes their verdicts to the address `verdicts`. */
/** @typedef {ReturnType<typeof graze_of>} Graze */

/** @type {readonly Verdict[]} */
export const kVerdicts = ['disjoint', 'intersects', 'declined'];
const kContacts = /** @type {const} */ (['none', 'point', 'segment', 'area']);
const kSites = ['plane_distance', 'parallel', 'orientation', 'separation'];
const kRelations = ['<', '<=', '==', '>', '>='];
const kMostPoints = 9;

/** @param {string} of @param {number} feature */
const feature_at = (of, feature) =>
  feature < 0
    ? ''
    : feature < 3
      ? `${of}[${feature}]`
      : feature < 6
        ? `edge ${of}[${feature - 3}] ${of}[${(feature - 2) % 3}]`
        : `face ${of}`;

/**
 * Makes the functions that use an instance of the module.
 * @param {any} exports @param {Host} host
 */
function graze_of(exports, host) {
  /** @type {WebAssembly.Memory} */
  const memory = exports.memory;
  const in_doubles = exports.coordinate_bytes() === 8,
    type = in_doubles ? 'double' : 'float32';
  /** Numbers of the pairs' type in the module's memory. @param {number} at @param {number} count */
  const numbers_at = (at, count) =>
    in_doubles ? new Float64Array(memory.buffer, at, count) : new Float32Array(memory.buffer, at, count);
  /** @param {number} at @param {number} count @returns {number[]} */
  const integers_at = (at, count) => [...new Int32Array(memory.buffer, at, count)];
  /** @param {number} at @param {number} count @returns {number[]} */
  const doubles_at = (at, count) => [...new Float64Array(memory.buffer, at, count)];

  /** @param {number} at */
  function text_at(at) {
    const bytes = new Uint8Array(memory.buffer, at);
    return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
  }

  /** @param {string} text */
  function set_text(text) {
    const bytes = new TextEncoder().encode(text);
    const room = new Uint8Array(memory.buffer, exports.text(), bytes.length + 1);
    room.set(bytes);
    room[bytes.length] = 0;
  }

  /** @param {Pair} pair @param {number} at */
  function set_pair(pair, at = exports.pairs()) {
    if (pair.length !== 18) throw new RangeError(`expected the 18 coordinates of a pair, found ${pair.length}`);
    numbers_at(at, 18).set(pair);
  }

  /** @param {number} at @param {number} count @returns {Point[]} */
  const points_at = (at, count) =>
    Array.from({ length: count }, (_, i) => /** @type {Point} */ (doubles_at(at + 24 * i, 3)));

  /** The file's path from the repository's root: "core/vec3.h". @param {number} at */
  const file_at = (at) => text_at(at).replace(/^.*?(?=core\/)/, '');

  const lanes = Array.from({ length: exports.lane_count() }, (_, i) => text_at(exports.lane_id(i)));
  const strata = Array.from(
    { length: exports.stratum_count() },
    (_, i) => text_at(exports.stratum_id(i)) + (in_doubles ? '/f64' : ''),
  );
  /** The verdicts of the last decision. @param {number} count */
  const verdicts_of = (count) => new Uint8Array(memory.buffer, exports.verdicts(), count).slice();

  /** @param {string} name @param {readonly string[]} names @param {string} what */
  function place(name, names, what) {
    const found = names.indexOf(name);
    if (found < 0) throw new RangeError(`expected ${what}, found '${name}'`);
    return found;
  }

  /** @param {string} id */
  const lane = (id) => place(id, lanes, 'one of the lanes');

  /** @param {Pair} pair */
  function truth_at(pair) {
    set_pair(pair);
    return /** @type {number} */ (exports.truth());
  }

  return {
    /** The type of the pairs: 'f32', or 'f64' with graze_f64.wasm. On doubles, a lane in f32 decides the coordinates rounded to float32. */
    coordinates: /** @type {'f32' | 'f64'} */ (in_doubles ? 'f64' : 'f32'),
    /** The lanes' names, "moller_1997/f32/cuda-fma". */
    lanes,
    /** The strata's names; those of doubles end in "/f64". */
    strata,
    /** The largest number of pairs in a call of the functions below that take several pairs. */
    room: /** @type {number} */ (exports.room()),
    /** For experts: the module's own functions, access to its texts and numbers, and the function that it calls. */
    exports,
    text_at,
    set_text,
    numbers_at,
    host,

    /**
     * Each lane's verdict on the pair; null if the lane cannot have the current policy.
     * @param {Pair} pair @returns {Record<string, Verdict | null>}
     */
    decide(pair) {
      set_pair(pair);
      return Object.fromEntries(lanes.map((id, i) => [id, exports.decide(i, 1) ? kVerdicts[verdicts_of(1)[0]] : null]));
    },

    /**
     * Whether two triangles intersect, exactly; touching counts. graze.wasm refuses a double that is not a float32,
     * because rounding it could change the answer.
     * @param {ArrayLike<number>} a 9 coordinates @param {ArrayLike<number>} b @returns {boolean}
     */
    intersects(a, b) {
      if (a.length !== 9 || b.length !== 9)
        throw new RangeError(`expected 9 coordinates of each triangle, found ${a.length} and ${b.length}`);
      for (const of of [a, b])
        for (let i = 0; i < 9; ++i)
          if (!Number.isFinite(of[i]) || (!in_doubles && Math.fround(of[i]) !== of[i]))
            throw new RangeError(
              `expected finite ${type} numbers, found ${of[i]}${Number.isFinite(of[i]) ? '; Math.fround rounds to them' : ''}`,
            );
      const pair = numbers_at(exports.pairs(), 18);
      pair.set(a);
      pair.set(b, 9);
      exports.decide_truth(1);
      return verdicts_of(1)[0] === 1;
    },

    /**
     * The exact verdict and relation of a pair with finite coordinates.
     * @param {Pair} pair @returns {Truth}
     */
    truth(pair) {
      const [verdict, contact, , a, b, coplanar] = integers_at(truth_at(pair), 6);
      return { verdict: kVerdicts[verdict], contact: kContacts[contact], coplanar: coplanar !== 0, dimensions: [a, b] };
    },

    /**
     * The pair's margin: certified bounds of the distance of disjoint triangles, or of the smallest translation that
     * separates intersecting triangles. For doubles whose sizes differ by a factor of more than about 2^250, the bounds
     * are 0 and infinity.
     * @param {Pair} pair @returns {Margin}
     */
    margin(pair) {
      const at = truth_at(pair),
        [, , sign, , , , log2_ulp] = integers_at(at, 7),
        [least, most] = doubles_at(at + 32, 2);
      return { sign: /** @type {-1 | 0 | 1} */ (sign), least, most, ulp: 2 ** log2_ulp };
    },

    /**
     * Sets the policy of all lanes except the exact ones: '', 'abs:E', 'rel:K', 'bound' or 'filtered'.
     * @param {string} policy
     */
    set_policy(policy) {
      const number = /^(?:abs|rel):(.+)$/.exec(policy);
      if (
        !['', 'bound', 'filtered'].includes(policy) &&
        !(number && Number(number[1]) >= 0 && Number.isFinite(Number(number[1])))
      )
        throw new RangeError(`expected abs:E, rel:K, bound, filtered or nothing, found '${policy}'`);
      set_text(policy);
      exports.set_policy();
    },

    /**
     * The float32, or the double, nearest to a decimal or hex float, rounded once; null if the text is not a number.
     * @param {string} text @returns {number | null}
     */
    parse(text) {
      if (text.length > 1000) return null;
      set_text(text);
      return exports.parse() ? numbers_at(exports.pairs(), 1)[0] : null;
    },

    /**
     * A pair of a stratum. It has the same bits on every machine.
     * @param {string} stratum @param {bigint} seed @param {bigint} index @returns {Float32Array | Float64Array}
     */
    generate(stratum, seed, index) {
      exports.generate(place(stratum, strata, 'a stratum'), seed, index, 1);
      return numbers_at(exports.pairs(), 18).slice();
    },

    /**
     * The float32, or the double, that is this many ulps above the number.
     * @param {number} x @param {number} ulps
     */
    nudged(x, ulps) {
      const number = numbers_at(exports.pairs(), 1);
      number[0] = x;
      exports.nudge(ulps);
      return number[0];
    },

    /**
     * One row of an ulp map. Coordinate x rises by `step` ulps from cell to cell, and the middle cell has the pair's
     * own x. Coordinate y is `up` ulps above the pair's. Returns the exact verdicts, then each lane's verdicts, as
     * indices in kVerdicts; null for a lane that cannot have the policy.
     * @param {Pair} pair @param {number} x @param {number} y @param {number} up @param {number} columns @param {number} step
     * @param {string[]} of @returns {(Uint8Array | null)[]}
     */
    map_row(pair, x, y, up, columns, step, of) {
      set_pair(pair, exports.centre());
      exports.map_row(x, y, up, columns, step);
      exports.decide_truth(columns);
      return [
        verdicts_of(columns),
        ...of.map((id) => (exports.decide(lane(id), columns) ? verdicts_of(columns) : null)),
      ];
    },

    /**
     * The points to draw besides the two triangles.
     * @param {Pair} pair @returns {Drawing}
     */
    drawing(pair) {
      set_pair(pair);
      const at = exports.draw(),
        [contact, line, a, b] = integers_at(at, 4);
      const points = at + 16,
        after = points + 24 * kMostPoints,
        [low_a, high_a, low_b, high_b] = doubles_at(after + 192, 4),
        [witness, feature_a, feature_b] = integers_at(after + 224, 3);
      return {
        contact: points_at(points, contact),
        line: points_at(after, line),
        sections: [points_at(after + 48, a), points_at(after + 96, b)],
        witness: points_at(after + 144, witness),
        along: [
          [low_a, high_a],
          [low_b, high_b],
        ],
        features: [feature_at('a', feature_a), feature_at('b', feature_b)],
      };
    },

    /**
     * The steps of a lane without a policy, in order: its comparisons, and the values that a policy would receive. A
     * lane in f32 rounds the pair to float32 first. Null if the steps are not known.
     * own: true if the values are known to be the lane's; false if they come from a contraction rule that gives the
     * lane's verdict.
     * with_113_bits: the algorithm's verdict if every operation is computed with 113 bits.
     * @param {Pair} pair @param {string} id @returns {{ own: boolean, steps: Step[], with_113_bits: Verdict } | null}
     */
    steps(pair, id) {
      set_pair(pair);
      const count = exports.steps(lane(id));
      if (count < 0) return null;
      const at = exports.steps_at();
      const steps = Array.from({ length: count }, (_, i) => {
        const step = at + 64 * i;
        const [file, line, site, compared, relation, held, holds, result] = integers_at(step, 8);
        const [left, right, exactLeft, exactRight] = doubles_at(step + 32, 4);
        return {
          line: `${file_at(file)}:${line}`,
          site: site < 0 ? '' : kSites[site],
          relation: compared ? kRelations[relation] : '',
          held: held !== 0,
          holds: holds !== 0,
          result,
          left,
          right,
          exactLeft,
          exactRight,
        };
      });
      return { own: exports.evidence() < 2, steps, with_113_bits: kVerdicts[exports.with_113_bits()] };
    },

    /**
     * The contractions that make a cuda-fma lane without a policy decide differently from cuda-nofma. Empty if the
     * verdicts are equal.
     * @param {Pair} pair @param {string} id @returns {Site[]}
     */
    contractions(pair, id) {
      set_pair(pair);
      const count = exports.contractions(lane(id));
      const at = exports.contractions_at();
      return Array.from({ length: count }, (_, i) => {
        const [file, from_file, line, from_line] = integers_at(at + 16 * i, 4);
        const from = file_at(from_file);
        return { line: `${file_at(file)}:${line}`, from: from && `${from}:${from_line}` };
      });
    },
  };
}

/**
 * Compiles and starts the module.
 * @param {BufferSource | WebAssembly.Module} bytes of graze.wasm or graze_f64.wasm @returns {Promise<Graze>}
 */
export async function load(bytes) {
  const module = bytes instanceof WebAssembly.Module ? bytes : await WebAssembly.compile(bytes);
  /** @type {Host} */
  const host = { decide() {} };
  const { exports } = await WebAssembly.instantiate(module, {
    graze: { decide: (/** @type {Parameters<Host['decide']>} */ ...of) => host.decide(...of) },
  });
  /** @type {any} */ (exports)._initialize();
  return graze_of(exports, host);
}
