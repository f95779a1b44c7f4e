// SPDX-License-Identifier: Apache-2.0
// The data that `graze view` writes into the page, and conversions of its pairs.
import type { Graze, Verdict } from './graze.js';
import { kVerdicts } from './graze.js';

export type Scalar = 'f32' | 'f64';
export type Coordinates = Float32Array | Float64Array; // 18: a[0].x to b[2].z

// bits: 18 words of 8 hex digits, or 16 for doubles. verdicts: a digit per lane, 0 disjoint, 1 intersects, 2 declined.
export interface Replay {
  lanes: string[];
  pairs: { bits: string; truth: Verdict; contact: string; verdicts: string }[];
}
// The data that the build stored for one coordinate type. module: graze.wasm or graze_f64.wasm, gzipped, in base64.
export interface Stored {
  module: string;
  evidence: string;
  replay: Replay;
}
// The verdict of a lane of the user's own code on a pair. stored: the verdict comes from the campaign, because the code
// has changed.
export interface Said {
  lane: string;
  verdict: string;
  wrong: boolean;
  stored: boolean;
}
export interface ViewData extends Stored {
  format: number;
  coordinates: Scalar;
  title: string;
  pairs: { name: string; bits: string; said?: Said[] }[];
  lanes_left_out?: { why: Record<string, string> }; // of the user's own code
  triangles: string[]; // of a mesh or a query, 9 words each; may be empty
  ids?: number[]; // ids of these triangles; without ids, they are numbered in order
  opens?: 'pair' | 'triangles' | 'random'; // triangles: all at once, against the first triangle of the pair
  random?: number; // how many random triangles are shown first
}

export function from_bits(bits: string, type: Scalar): Coordinates {
  const digits = type === 'f64' ? 16 : 8,
    words = Array.from({ length: bits.length / digits }, (_, i) => bits.slice(digits * i, digits * (i + 1)));
  return type === 'f64'
    ? new Float64Array(BigUint64Array.from(words, (word) => BigInt(`0x${word}`)).buffer)
    : new Float32Array(Uint32Array.from(words, (word) => parseInt(word, 16)).buffer);
}

export function to_bits(pair: Coordinates): string {
  const { buffer } = pair.slice();
  return pair instanceof Float64Array
    ? Array.from(new BigUint64Array(buffer), (word) => word.toString(16).padStart(16, '0')).join('')
    : Array.from(new Uint32Array(buffer), (word) => word.toString(16).padStart(8, '0')).join('');
}

// The coordinate type of a pair in a link, from the number of hex digits; null for a text that is not a pair.
export const type_of_bits = (bits: string): Scalar | null =>
  /^([0-9a-f]{144}|[0-9a-f]{288})$/.test(bits) ? (bits.length === 288 ? 'f64' : 'f32') : null;

// The numbers, rounded to this type.
export const stored_as = (type: Scalar, numbers: ArrayLike<number>): Coordinates =>
  type === 'f64' ? Float64Array.from(numbers) : Float32Array.from(numbers);

// The shortest decimal whose nearest number of this type is x.
export function decimal(x: number, type: Scalar): string {
  if (!Number.isFinite(x)) return String(x);
  if (Object.is(x, -0)) return '-0';
  if (type === 'f64') return String(x);
  for (let digits = 1; digits < 9; ++digits) {
    const text = x.toPrecision(digits);
    if (Math.fround(Number(text)) === x) return String(Number(text));
  }
  return String(Number(x.toPrecision(9)));
}

// Hex floats as C's %a writes them: 0x1.8p+1.
export function hex_float(x: number): string {
  if (!Number.isFinite(x)) return Number.isNaN(x) ? 'nan' : x > 0 ? 'inf' : '-inf';
  const sign = x < 0 || Object.is(x, -0) ? '-' : '';
  if (x === 0) return `${sign}0x0p+0`;
  let exponent = Math.floor(Math.log2(Math.abs(x)));
  if (2 ** exponent > Math.abs(x)) --exponent;
  const digits = ((Math.abs(x) / 2 ** exponent - 1) * 2 ** 52).toString(16).padStart(13, '0').replace(/0+$/, '');
  return `${sign}0x1${digits ? `.${digits}` : ''}p${exponent < 0 ? '' : '+'}${exponent}`;
}

export const coordinate_name = (c: number) => `${c < 9 ? 'a' : 'b'}[${Math.floor(c / 3) % 3}].${'xyz'[c % 3]}`;

// Decides the stored pairs again.   Returns: the differences from the native build, in words; empty if there are none.
export function replay(graze: Graze, { lanes, pairs }: Replay): string[] {
  const apart: string[] = [];
  const say = (i: number, what: string, here: unknown, native: unknown) =>
    apart.push(`stored pair ${i + 1}, ${what}: here ${here}, natively ${native}`);
  if (pairs.length === 0) apart.push('this page holds no stored verdicts');
  pairs.forEach((stored, i) => {
    const pair = from_bits(stored.bits, graze.coordinates),
      truth = graze.truth(pair),
      verdicts = graze.decide(pair);
    if (truth.verdict !== stored.truth) say(i, 'truth', truth.verdict, stored.truth);
    if (truth.contact !== stored.contact) say(i, 'contact', truth.contact, stored.contact);
    lanes.forEach((lane, k) => {
      const native = kVerdicts[Number(stored.verdicts[k])];
      if (verdicts[lane] !== native) say(i, lane, verdicts[lane] ?? 'nothing', native);
    });
  });
  return apart;
}
