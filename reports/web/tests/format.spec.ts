// SPDX-License-Identifier: Apache-2.0
// Bounds are rounded outward: the printed number is never below an upper bound or above a lower bound.
import { expect, test } from '@playwright/test';
import { interval, percent_bound } from '../src/format';

const kSuperscripts = '⁰¹²³⁴⁵⁶⁷⁸⁹';

// Reads "0.021 %" or "1.23·10⁻⁵ %" as a share.
function read(text: string): number {
  const [, digits, sign, power] = /^([\d.]+)(?:·10(⁻?)([⁰¹²³⁴⁵⁶⁷⁸⁹]+))? %$/.exec(text)!;
  const exponent = power ? [...power].map((c) => kSuperscripts.indexOf(c)).join('') : '0';
  return Number(`${digits}e${sign ? '-' : ''}${exponent}`) / 100;
}

test('bounds are rounded outward', () => {
  let seed = 2012;
  const draw = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
  let rounded = 0;
  const wrong: string[] = [];
  for (let i = 0; i < 100_000; ++i) {
    const share = i % 4 === 0 ? Number((10 ** (-12 * draw())).toPrecision(1 + ((i / 4) % 4))) : 10 ** (-12 * draw());
    const upper = percent_bound(share, 'upper'),
      lower = percent_bound(share, 'lower');
    const within = read(upper) >= share && read(lower) <= share;
    const near = read(upper) <= share * 1.011 + 1.0001e-5 && read(lower) >= share * 0.989 - 1.0001e-5;
    if (!within || !near) wrong.push(`${share}: ${lower} to ${upper}`);
    rounded += Number(upper !== lower);
  }
  expect(wrong.slice(0, 5)).toEqual([]);
  expect(rounded).toBeGreaterThan(70_000);
  expect(percent_bound(0.0002032, 'upper')).toBe('0.021 %');
  expect(percent_bound(0.02, 'upper')).toBe('2.00 %');
  expect(percent_bound(0, 'lower')).toBe('0 %');
  expect(percent_bound(1, 'upper')).toBe('100 %');
  expect(percent_bound(0.9996, 'upper')).toBe('100.0 %');
  expect(interval({ count: 1, of: 3, share: 0.3333, low: 0.06149, high: 0.79235 })).toBe('6.14 to 79.3 %');
});
