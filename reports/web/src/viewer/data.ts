// SPDX-License-Identifier: Apache-2.0
// The data that `graze view` writes into the page, and its pairs.
import type { Graze, Verdict } from './graze.js';
import { kVerdicts } from './graze.js';

export type Coordinates = Float32Array; // 18: a[0].x to b[2].z

// bits: 18 words of 8 hex digits. verdicts: a digit for each lane, 0 disjoint, 1 intersects, 2 declined.
export interface Replay {
  lanes: string[];
  pairs: { bits: string; truth: Verdict; contact: string; verdicts: string }[];
}
export interface Stored {
  evidence: string;
  replay: Replay;
} // of the build; `graze report` writes only these
// What a lane of the user's own code says of a pair; `stored`: in the campaign, whose code is not there any more.
export interface Said {
  lane: string;
  verdict: string;
  wrong: boolean;
  stored: boolean;
}
export interface ViewData extends Stored {
  format: number;
  title: string;
  pairs: { name: string; bits: string; said?: Said[] }[];
  lanes_left_out?: { why: Record<string, string> }; // of the user's own code
  triangles: string[]; // of a mesh or a query, 9 words each; may be empty
  ids?: number[]; // of these triangles; without it, they are numbered as they come
  opens?: 'pair' | 'triangles' | 'random'; // triangles: all at once, against the first triangle of the pair
  random?: number; // how many random triangles are drawn first
}

export function from_bits(bits: string): Coordinates {
  const words = new Uint32Array(bits.length / 8);
  for (let i = 0; i < words.length; ++i) words[i] = parseInt(bits.slice(8 * i, 8 * i + 8), 16);
  return new Float32Array(words.buffer);
}

export function to_bits(pair: Coordinates): string {
  return Array.from(new Uint32Array(pair.slice().buffer), (word) => word.toString(16).padStart(8, '0')).join('');
}

// The shortest decimal whose nearest float32 is this number.
export function decimal(x: number): string {
  if (!Number.isFinite(x)) return String(x);
  if (Object.is(x, -0)) return '-0';
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
  const digits = Math.round((Math.abs(x) / 2 ** exponent - 1) * 2 ** 24)
    .toString(16)
    .padStart(6, '0')
    .replace(/0+$/, '');
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
    const pair = from_bits(stored.bits),
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
