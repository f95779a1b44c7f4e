// SPDX-License-Identifier: Apache-2.0
// Formats the numbers of a lane's steps, and quotes their source lines.
import sources from 'graze.sources';
import { h } from '../dom';
import { figure } from '../format';
import type { Step } from './graze.js';

export const code = (text: string) => h('code', {}, text);
export const outcome = (held: boolean) => (held ? 'yes' : 'no');

const number = (x: number) =>
  Object.is(x, -0)
    ? '-0'
    : x === 0 || !Number.isFinite(x) || (Number.isInteger(x) && Math.abs(x) < 1e6)
      ? String(x)
      : figure(x);

const in_full = (x: number) => (Object.is(x, -0) ? '-0' : String(Number(x.toPrecision(9))));

// The distance between neighbouring numbers of this scalar near x.
export const ulp_of = (scalar: string) => (x: number) =>
  2 ** (Math.floor(Math.log2(Math.abs(x) || 2 ** -100)) - (scalar === 'f32' ? 23 : 52));

// Writes the numbers with just enough digits to tell them apart.
export function told_apart(numbers: number[]): string[] {
  const distinct = new Set(numbers.map((x) => (x === 0 ? 0 : x))).size;
  const unlike = (texts: string[]) => new Set(texts.map((text) => (text === '-0' ? '0' : text))).size === distinct;
  let texts = numbers.map(number);
  for (let digits = 4; !unlike(texts) && digits <= 17; ++digits)
    texts = numbers.map((x) => (x === 0 ? number(x) : String(Number(x.toPrecision(digits)))));
  return texts;
}

export function compared(step: Step, exact = false) {
  const sides = exact ? [step.exactLeft, step.exactRight] : [step.left, step.right];
  const [left, right] = sides[0] === sides[1] ? sides.map(in_full) : told_apart(sides);
  return step.relation ? `${left} ${step.relation} ${right}` : left;
}

// "core/vec3.h:48", and the code at that line.
export function quoted(place: string) {
  const [file, line] = place.split(':'),
    lines = sources[file] ?? [];
  let text = lines[Number(line) - 1] ?? '';
  for (let next = Number(line); /(\|\||&&|,|\()$/.test(text) && next < lines.length; ++next) text += ` ${lines[next]}`; // continues to the end of the statement
  return h(
    'span',
    { class: 'quoted' },
    h('code', { class: 'place' }, place),
    text && h('code', { class: 'line' }, text),
  );
}
