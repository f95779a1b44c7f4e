// SPDX-License-Identifier: Apache-2.0
// three-mesh-bvh's ExtendedTriangle.intersectsTriangle (MIT, https://github.com/gkjohnson/three-mesh-bvh), over the
// line protocol. Each line has 18 hexadecimal numbers, and the answer is 0 or 1. The library states no convention.
import { ExtendedTriangle } from 'three-mesh-bvh';

const kHex = /^(-?)0x([0-9a-f]+)\.?([0-9a-f]*)p([+-]?\d+)$/i;

function number(text) {
  const match = kHex.exec(text);
  if (!match) return Number(text);
  const [, sign, whole, fraction, exponent] = match;
  const power = Number(exponent) - 4 * fraction.length;
  // Multiplies in two exact steps, because 2 ** power alone underflows to 0 for some nonzero results.
  const value = parseInt(whole + fraction, 16) * 2 ** Math.max(-1000, power) * 2 ** Math.min(0, power + 1000);
  return sign ? -value : value;
}

const first = new ExtendedTriangle();
const second = new ExtendedTriangle();

function answer(line) {
  const v = line.trim().split(/\s+/).map(number);
  first.a.set(v[0], v[1], v[2]);
  first.b.set(v[3], v[4], v[5]);
  first.c.set(v[6], v[7], v[8]);
  second.a.set(v[9], v[10], v[11]);
  second.b.set(v[12], v[13], v[14]);
  second.c.set(v[15], v[16], v[17]);
  first.needsUpdate = second.needsUpdate = true;
  return first.intersectsTriangle(second) ? '1\n' : '0\n';
}

let unread = '';
process.stdin.setEncoding('ascii').on('data', (text) => {
  const lines = (unread + text).split('\n');
  unread = lines.pop();
  if (lines.length > 0) process.stdout.write(lines.map(answer).join(''));
});
