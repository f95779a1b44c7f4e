// SPDX-License-Identifier: Apache-2.0
// Formats numbers for readers, always in English notation, so a report looks the same everywhere.
import type { Quartiles, Share } from './report';

export const count = (n: number) => n.toLocaleString('en-US');

const kSuperscripts: Record<string, string> = { '-': '⁻' };
'⁰¹²³⁴⁵⁶⁷⁸⁹'.split('').forEach((digit, i) => (kSuperscripts[i] = digit));
const raised = (n: number) => [...String(n)].map((c) => kSuperscripts[c]).join('');

// 2⁻¹²
export const power_of_two = (exponent: number) => `2${raised(exponent)}`;

// "1 pair", "2,048 pairs"
export const counted = (n: number, what: string) => `${count(n)} ${what}${n === 1 ? '' : 's'}`;

// A margin bucket in words: "-2^-3" as "2⁻³ ulps deep", "2^4" as "2⁴ ulps".
export function margin_words(margin: string): string {
  const found = /^([-+]?)2\^(-?\d+)$/.exec(margin);
  if (!found) return margin;
  return `${power_of_two(Number(found[2]))} ulps${found[1] === '-' ? ' deep' : ''}`;
}

// A sort key for margin buckets, by signed size: "-2^-3" comes before "0", and "0" before "2^4".
export function margin_order(margin: string) {
  const found = /^([-+]?)2\^(-?\d+)$/.exec(margin);
  return found ? (found[1] === '-' ? -1 : 1) * (Number(found[2]) + 200) : 0;
}

// A number with three significant digits, written with a power of ten if it is below 0.001 or at least 10^6.
export function figure(value: number): string {
  if (value === 0 || !Number.isFinite(value)) return String(value);
  const exponent = Math.floor(Math.log10(Math.abs(value)));
  if (exponent >= -3 && exponent < 6) return count(Number(value.toPrecision(3)));
  const [digits, power] = value.toExponential(2).split('e');
  return `${Number(digits)}·10${raised(Number(power))}`;
}

// Whether a cost's quartiles are further apart than a quarter of its median, as in reports/cost_words.h.
export const is_noisy = (cost: Quartiles) => cost.high - cost.low > 0.25 * cost.middle;

// "quartiles 8.4 to 8.9", for the title of a cost.
export const spread_words = (cost: Quartiles) =>
  `quartiles ${figure(cost.low)} to ${figure(cost.high)}${is_noisy(cost) ? '; noisy: measure again on an idle machine' : ''}`;

export const noisy_mark = (cost: Quartiles) => (is_noisy(cost) ? ' (noisy)' : '');

// "42 ns", "8.5 ns"
export const nanoseconds = (value: number) => `${value.toFixed(value < 10 ? 1 : 0)} ns`;

// The number of decimal places of a percentage.
const places = (percent: number) => (percent >= 10 ? 1 : percent >= 1 ? 2 : 3);

// A share as a percentage without the sign: 47.8, 0.156, <0.001.
export function bare_percent(share: number): string {
  const percent = 100 * share;
  if (percent === 0 || percent === 100) return String(percent);
  if (percent < 0.001) return '<0.001';
  if (percent > 99.9) return '>99.9';
  return percent.toFixed(places(percent));
}

const small = (percent: number) => percent !== 0 && percent < 0.001;

export const percent = (share: number) => `${small(100 * share) ? figure(100 * share) : bare_percent(share)} %`;

// A bound in per cent, rounded outward: the printed number is never below an upper bound or above a lower bound.
export function percent_bound(share: number, bound: 'lower' | 'upper'): string {
  const value = 100 * share,
    step = bound === 'upper' ? 1 : -1;
  const holds = (read: number) => (bound === 'upper' ? read / 100 >= share : read / 100 <= share);
  if (value === 0 || value === 100) return `${value} %`;
  if (small(value)) {
    const [digits, power] = value.toExponential(2).split('e'),
      mantissa = Math.round(100 * Number(digits));
    const read = [mantissa, mantissa + step].map((m) => Number(`${m}e${Number(power) - 2}`)).find(holds)!;
    return `${figure(read)} %`;
  }
  const digits = places(value),
    units = Math.round(Number(value.toFixed(digits)) * 10 ** digits);
  return `${[units, units + step].map((u) => (u / 10 ** digits).toFixed(digits)).find((text) => holds(Number(text)))!} %`;
}

export const interval = (share: Share) =>
  `${percent_bound(share.low, 'lower').replace(' %', '')} to ${percent_bound(share.high, 'upper')}`;

// "10,802 of 52,632 = 20.5 % (95 %: 20.2 to 20.9 %)"
export const in_full = (share: Share) =>
  share.of === 0
    ? 'no pairs'
    : `${count(share.count)} of ${count(share.of)} = ${percent(share.share)} (95 %: ${interval(share)})`;
