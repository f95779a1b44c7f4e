// SPDX-License-Identifier: Apache-2.0
// Compares a module with the native build, and tests graze.js.   Usage: node graze.test.mjs REFERENCE MODULE PAIRS
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { load } from './graze.js';

const [reference, module, pairs] = process.argv.slice(2);
const graze = await load(readFileSync(module));
const { exports } = graze;
const kSeed = 20120131n,
  kBlock = 1000,
  kFew = 5;

// The same hash as in reference.cpp.
class Hash {
  value = 0x811c9dc5;
  scratch = new DataView(new ArrayBuffer(8));
  add(bytes) {
    let hash = this.value;
    for (let i = 0; i < bytes.length; ++i) hash = Math.imul(hash ^ bytes[i], 0x01000193);
    this.value = hash >>> 0;
    return this;
  }
  whole(x) {
    this.scratch.setInt32(0, x, true);
    this.add(new Uint8Array(this.scratch.buffer, 0, 4));
  }
  number(x) {
    this.scratch.setFloat64(0, Number.isNaN(x) ? 0.25 : x, true);
    this.add(new Uint8Array(this.scratch.buffer));
  }
}

const bytes = (at, count) => new Uint8Array(exports.memory.buffer, at, count);
const line_of = (place) => Number(place.split(':').at(-1));
const in_doubles = graze.coordinates === 'f64';
const kPairBytes = in_doubles ? 144 : 72;
const pair_at = (i) => graze.numbers_at(exports.pairs() + kPairBytes * i, 18).slice();
const filled = (make) => {
  const hash = new Hash();
  make(hash);
  return hash.value;
};

function truths(count) {
  const all = Array.from({ length: count }, (_, i) => pair_at(i));
  return filled((hash) => {
    for (const pair of all) {
      bytes(exports.pairs(), kPairBytes).set(new Uint8Array(pair.buffer));
      const data = new DataView(exports.memory.buffer, exports.truth());
      for (let k = 0; k < 7; ++k) hash.whole(data.getInt32(4 * k, true));
      hash.number(data.getFloat64(32, true));
      hash.number(data.getFloat64(40, true));
    }
  });
}

function steps(lane, few) {
  return filled((hash) => {
    for (const pair of few) {
      const found = graze.steps(pair, lane)?.steps;
      if (!found) continue;
      hash.whole(
        found.reduce(
          (sum, { line, held, left, right }) =>
            (sum +
              filled((step) => {
                step.whole(line_of(line));
                step.whole(Number(held));
                step.number(left);
                step.number(right);
              })) |
            0,
          0,
        ),
      );
      for (const { line } of graze.contractions(pair, lane)) hash.whole(line_of(line));
    }
  });
}

// Computes the hash that the native build prints for this block.
function compute(what, stratum, block, count) {
  const draw = () => exports.generate(graze.strata.indexOf(stratum), kSeed, BigInt(block * kBlock), count);
  draw();
  if (what === 'pairs') return new Hash().add(bytes(exports.pairs(), kPairBytes * count)).value;
  if (what === 'truth') return truths(count);
  const [kind, id] = what.includes(':') && /^(trace|steps):/.test(what) ? what.split(/:(.*)/s) : ['', what];
  const [subject, scalar, variant, policy] = id.split('/');
  const lane = graze.lanes.indexOf(`${subject}/${scalar}/${variant}`);
  assert.ok(lane >= 0, `the module has no lane ${id}`);
  if (kind === 'steps')
    return steps(
      id,
      Array.from({ length: Math.min(kFew, count) }, (_, i) => pair_at(i)),
    );
  if (kind === 'trace') {
    assert.ok(exports.trace(lane, count), `${id} has no trace`);
    return new Hash().add(bytes(exports.hashes(), 8 * count)).value;
  }
  if (policy) graze.set_policy(policy);
  const has = exports.decide(lane, count);
  if (policy) graze.set_policy('');
  assert.ok(has, `${what}: the module cannot decide`);
  return new Hash().add(bytes(exports.verdicts(), count)).value;
}

// The fused multiply-add, computed in exact arithmetic. x, y and z are integers times 2^-149.
function fused_exactly(x, y, z) {
  const whole = (v) => BigInt(v * 2 ** 149); // exact, because v < 2^128
  let sum = whole(x) * whole(y) + (whole(z) << 149n); // times 2^-298
  if (sum === 0n) return 0;
  const negative = sum < 0n;
  if (negative) sum = -sum;
  const bits = BigInt(sum.toString(2).length);
  const drop = bits - 24n > 149n ? bits - 24n : 149n; // bits below the 24th, or below 2^-149
  let kept = sum >> drop;
  const rest = sum - (kept << drop),
    half = 1n << (drop - 1n);
  if (rest > half || (rest === half && kept & 1n)) kept += 1n;
  const value = Number(kept) * 2 ** Number(drop - 200n) * 2 ** -98;
  return negative ? -value : value;
}

function check_fused() {
  let state = 1;
  const below = (n) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0; // the generator of Numerical Recipes is random enough here
    return Math.floor((state / 2 ** 32) * n);
  };
  let halfway = 0;
  for (let i = 0; i < 100_000; ++i) {
    const exponent = -100 + below(80),
      total = -160 + below(40);
    const x = (1 + below(4095)) * 2 ** exponent,
      y = (1 + below(4095)) * 2 ** Math.max(-149, total - exponent);
    const z = (below(2 ** 21) - 2 ** 20) * 2 ** (-149 + below(8));
    const exact = fused_exactly(x, y, z);
    assert.equal(exports.fused(x, y, z) + 0, exact + 0, `fused(${x}, ${y}, ${z})`);
    halfway += Number(Math.fround(Math.fround(x * y) + z) !== exact);
  }
  assert.ok(halfway > 1000, `two roundings differ from one on ${halfway} of the cases: too few to test anything`);
}

function check_interface_of_doubles() {
  assert.equal(graze.parse('0.1'), 0.1);
  assert.equal(graze.parse('-0x1.8000000000001p+1'), -3 - 2 ** -51);
  // This number lies between two doubles.
  assert.equal(graze.parse('1.0000000000000001110223024625156540424'), 1 + 2 ** -52);
  for (const text of ['', 'x', '1e309', '1 2', '0x']) assert.equal(graze.parse(text), null, text);
  assert.equal(graze.nudged(0, -1), -(2 ** -1074));
  assert.equal(graze.nudged(1, 1), 1 + 2 ** -52);
  // Two parallel triangles from a model in metres. They are disjoint as doubles and coincide in float32.
  const at = (x) => [x, 0, 0, x, 1, 0, x, 0, 1],
    apart = [...at(1000000.01), ...at(1000000.02)];
  assert.equal(graze.truth(apart).verdict, 'disjoint');
  assert.equal(graze.intersects(at(1000000.01), at(1000000.02)), false);
  const { sign, least, most } = graze.margin(apart),
    gap = 1000000.02 - 1000000.01; // exact, by Sterbenz
  assert.ok(sign === 1 && least <= gap && most >= gap && most - least < 1e-12 * gap);
  const said = graze.decide(apart);
  for (const id of graze.lanes) assert.equal(said[id], id.includes('/f32/') ? 'intersects' : 'disjoint', id);
  // The margins are certified even near the ends of the range of doubles.
  for (const exponent of [-1060, -500, 900, 1020]) {
    const scale = 2 ** exponent,
      { least, most } = graze.margin([...at(1), ...at(1.5)].map((x) => x * scale));
    assert.ok(least <= scale / 2 && most >= scale / 2 && most - least < 1e-3 * scale, `at 2^${exponent}`);
  }
  const spread = [...at(2 ** -1000), ...at(2 ** 1000)];
  assert.deepEqual(graze.margin(spread), { sign: 1, least: 0, most: Infinity, ulp: 2 ** 948 });
}

function check_interface() {
  assert.equal(graze.parse('0.1'), Math.fround(0.1));
  assert.equal(graze.parse('-0x1.8p+1'), -3);
  // This number lies between two floats. If it were rounded to double first, the result would be the other float.
  assert.equal(graze.parse('1.000000059604644775390626'), 1 + 2 ** -23);
  for (const text of ['', 'x', '1e39', '1 2', '0x']) assert.equal(graze.parse(text), null, text);
  assert.equal(graze.nudged(0, -1), -(2 ** -149));
  assert.throws(() => graze.set_policy('abs:x'), /expected abs:E/);
  assert.throws(() => graze.decide([1, 2]), /expected the 18 coordinates/);
  const case_1 = [0, -2, 6, 0, 5, 0, 0, -3, 0, -2, -2, 0, 2, -3, 0, 3, -1, 0]; // case 1 of thesis_2012.pairs
  assert.deepEqual(graze.truth(case_1), {
    verdict: 'intersects',
    contact: 'segment',
    coplanar: false,
    dimensions: [2, 2],
  });
  const { contact, sections } = graze.drawing(case_1);
  assert.deepEqual(contact.map(([, y]) => y).sort(), [-1.6, -2.5]); // computed by hand in corpus/classic/thesis_2012.pairs
  assert.equal(
    sections.every((ends) => ends.length === 2),
    true,
  );
  const { sign, least, most } = graze.margin([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0.5, 1, 0, 0.5, 0, 1, 0.5]);
  assert.ok(sign === 1 && least <= 0.5 && most >= 0.5 && most - least < 1e-9);
  const output = execFileSync(process.execPath, [fileURLToPath(new URL('example.mjs', import.meta.url)), module], {
    encoding: 'utf8',
  });
  assert.match(
    output,
    /touching: intersects, contact point, margin 0.00 to 0.00\na quarter above: disjoint, contact none, margin 0.250 to 0.250\n/,
  );
  assert.match(output, /cuda-fma: disjoint\n$/);
}

// The witness's length lies within the margin's bounds, up to the rounding of the witness's ends. For a gap, the
// witness's direction separates the triangles.
function check_witness() {
  const found = { gap: 0, push: 0 };
  for (const stratum of graze.strata) {
    for (let index = 0; index < 60; ++index) {
      const pair = graze.generate(stratum, 7n, BigInt(index)),
        { sign, least, most } = graze.margin(pair),
        { witness, along: reach, features } = graze.drawing(pair),
        where = `${stratum}:7:${index}`;
      if (sign === 0) assert.equal(witness.length, 0, where);
      if (witness.length === 0 && (sign === 0 || least < 2 ** -90 * Math.max(...pair.map(Math.abs)))) continue; // too small a gap for 113 bits
      assert.equal(witness.length, 2, where);
      const [p, q] = witness,
        axis = q.map((x, k) => x - p[k]),
        length = Math.hypot(...axis),
        size = Math.max(...pair.map(Math.abs), ...p.map(Math.abs)),
        slack = 1e-9 * most + 8 * 2 ** -52 * size;
      if (!Number.isFinite(most)) continue; // infinite bounds allow any length
      assert.ok(
        length >= least - slack && length <= most + slack,
        `${where}: ${length}, margin between ${least} and ${most}`,
      );
      assert.ok(
        reach[0][1] === 0 && Math.abs(Math.abs(reach[1][0]) - length) <= slack && reach[1][0] > 0 === sign > 0,
        `${where}: ${reach}`,
      );
      if (sign > 0) {
        const along = Array.from({ length: 6 }, (_, v) =>
          axis.reduce((sum, x, k) => sum + (x / length) * (pair[3 * v + k] - p[k]), 0),
        );
        const turned = (32 * 2 ** -52 * size * size) / most; // error due to the rounding of the ends
        if (most > 1e-6 * size)
          assert.ok(Math.max(...along.slice(0, 3)) <= turned && Math.min(...along.slice(3)) >= least - turned, where);
        assert.ok(features.every(Boolean), where);
      }
      ++found[sign > 0 ? 'gap' : 'push'];
    }
  }
  assert.ok(found.gap > 200 && found.push > 100, JSON.stringify(found));
}

function compare() {
  const lines = execFileSync(reference, [pairs, graze.coordinates], { encoding: 'utf8', maxBuffer: 2 ** 30 })
    .trim()
    .split('\n');
  const each = Math.ceil(Number(pairs) / graze.strata.length);
  const compared = new Map();
  for (const line of lines) {
    const [what, stratum, block, expected] = line.split(' ');
    const count = Math.min(each - Number(block) * kBlock, kBlock);
    assert.equal(
      compute(what, stratum, Number(block), count),
      Number(expected),
      `${what} on block ${block} of ${stratum}`,
    );
    compared.set(what, (compared.get(what) ?? 0) + count);
  }
  const lanes = graze.lanes.filter((id) => compared.has(id));
  assert.deepEqual(lanes, graze.lanes);
  const kinds = (kind) => [...compared.keys()].filter((what) => what.startsWith(kind)).length;
  assert.ok(kinds('trace:') > 0 && kinds('steps:') > 0);
  console.log(
    `${compared.get('pairs')} pairs of ${graze.strata.length} strata: 0 differences in the verdicts of ${lanes.length} lanes and the truth, in the trace hashes of ${kinds('trace:')} lanes`,
  );
}

check_fused();
if (in_doubles) check_interface_of_doubles();
else check_interface();
check_witness();
compare();
