// SPDX-License-Identifier: Apache-2.0
// The input fields of the 18 coordinates: a coordinate can be chosen, typed, pasted and stepped.
import { button, h, section, table, table_row } from '../dom';
import { coordinate_name, decimal, hex_float, stored_as } from './data';
import type { Model } from './model';

export const kSteps = [
  ['1 ulp', 1],
  ['256 ulps', 256],
  ['65,536 ulps', 65536],
] as const;
export const kMove = 0.0625; // the same step as in the thesis's viewer

// Finds numbers in any notation, with any text between them.
function numbers_in(text: string): string[] {
  return text.match(/[-+]?(?:0x[0-9a-f.]+(?:p[-+]?\d+)?|(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)/gi) ?? [];
}

export function coordinates(model: Model, say: (text: string) => void) {
  const type = model.graze.coordinates === 'f64' ? 'double' : 'float32';
  const fields = Array.from({ length: 18 }, (_, c) =>
    h('input', {
      type: 'text',
      inputmode: 'decimal',
      spellcheck: 'false',
      autocomplete: 'off',
      'aria-label': coordinate_name(c),
      'data-coordinate': c,
      onfocus: () => model.chosen !== c && model.set({ chosen: c }),
      onchange: (event: Event) => {
        const text = (event.target as HTMLInputElement).value,
          value = model.graze.parse(text.trim());
        if (value === null) {
          say(`expected a number of ${type} for ${coordinate_name(c)}, found '${text}'`);
          return show(c);
        }
        model.change((pair) => (pair[c] = value));
        show(c);
      },
      onpaste: (event: ClipboardEvent) => {
        const found = numbers_in(event.clipboardData?.getData('text') ?? '');
        if (found.length < 2) return; // a single number is pasted as usual
        event.preventDefault();
        take(found);
      },
    }),
  );

  function take(texts: string[]) {
    const values = texts.map((text) => model.graze.parse(text));
    if (texts.length !== 18 || values.some((value) => value === null))
      return say(
        `expected the 18 coordinates of a pair, found ${texts.length} numbers${values.some((value) => value === null) ? `, not all of ${type}` : ''}`,
      );
    model.show(stored_as(model.graze.coordinates, values as number[]), 'a pasted pair');
  }

  const exactly = h('p', { class: 'small', id: 'exactly' });
  const steps = h(
    'div',
    { class: 'chips', role: 'group', 'aria-label': 'Step the chosen coordinate' },
    kSteps.flatMap(([name, ulps]) => [
      button(`− ${name}`, () => model.step(-ulps)),
      button(`+ ${name}`, () => model.step(ulps)),
    ]),
    button(`− ${kMove}`, () => model.change((pair) => (pair[model.chosen] -= kMove))),
    button(`+ ${kMove}`, () => model.change((pair) => (pair[model.chosen] += kMove))),
  );

  const shown: number[] = [];
  function show(c: number) {
    shown[c] = model.pair[c];
    fields[c].value = decimal(shown[c], model.graze.coordinates);
  }
  function update() {
    fields.forEach((field, c) => {
      if (!Object.is(shown[c], model.pair[c])) show(c); // keep the text that is being typed
      field.classList.toggle('chosen', c === model.chosen);
    });
    const value = model.pair[model.chosen],
      size = Math.abs(value);
    exactly.replaceChildren(
      h('strong', {}, coordinate_name(model.chosen)),
      ' is exactly ',
      h('code', {}, hex_float(value)),
      '; an ulp of it is ',
      h('code', {}, String(model.graze.nudged(size, 1) - size)),
    );
  }
  const row = (v: number) =>
    table_row(
      `${v < 3 ? 'a' : 'b'}[${v % 3}]`,
      [0, 1, 2].map((k) => h('td', {}, fields[3 * v + k])),
    );
  return {
    update,
    element: section(
      'coordinates',
      'Coordinates',
      table(
        'plain pair',
        `In ${type}. Type a number, or paste 18 numbers into any field.`,
        ['', 'x', 'y', 'z'],
        [0, 1, 2, 3, 4, 5].map(row),
      ),
      steps,
      exactly,
    ),
  };
}
