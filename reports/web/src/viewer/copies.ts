// SPDX-License-Identifier: Apache-2.0
// The pair as text to paste elsewhere.
import { button, code_block, h, section } from '../dom';
import { decimal, hex_float, type Coordinates } from './data';
import type { Model } from './model';

const vectors = (of: (x: number) => string, pair: ArrayLike<number>, open: string, close: string) =>
  Array.from({ length: 6 }, (_, v) => `${open}${[0, 1, 2].map((k) => of(pair[3 * v + k])).join(', ')}${close}`);
// Literals of the pair's type, and the type's name.
const literals = (pair: Coordinates) =>
  pair instanceof Float64Array
    ? { type: 'double', of: hex_float }
    : { type: 'float', of: (x: number) => `${hex_float(x)}f` };

const kCopies: Record<string, (model: Model) => string> = {
  'check line': ({ pair }) =>
    `${Array.from(pair, hex_float).join(' ')}${pair instanceof Float64Array ? ' | coordinates=f64' : ''}\n`,
  C: ({ pair, name }) => {
    const { type, of } = literals(pair),
      rows = vectors(of, pair, '{', '}');
    return `/* ${name} */\nconst ${type} a[3][3] = {${rows.slice(0, 3).join(', ')}};\nconst ${type} b[3][3] = {${rows.slice(3).join(', ')}};\n`;
  },
  CUDA: ({ pair, name }) => {
    const { type, of } = literals(pair),
      rows = vectors(of, pair, '{', '}');
    return `// ${name}\n__constant__ ${type}3 a[3] = {${rows.slice(0, 3).join(', ')}};\n__constant__ ${type}3 b[3] = {${rows.slice(3).join(', ')}};\n`;
  },
  Python: ({ pair, name }) => {
    const rows = vectors((x) => `float.fromhex("${hex_float(x)}")`, pair, '(', ')');
    return `# ${name}\na = [${rows.slice(0, 3).join(', ')}]\nb = [${rows.slice(3).join(', ')}]\n`;
  },
  OBJ: ({ pair, name, graze }) =>
    `# ${name}\n${Array.from({ length: 6 }, (_, v) => `v ${[0, 1, 2].map((k) => decimal(pair[3 * v + k], graze.coordinates)).join(' ')}`).join('\n')}\nf 1 2 3\nf 4 5 6\n`,
};

// link: returns the address of the page with this pair.
export function copies(model: Model, link: (model: Model) => string) {
  const shown = h('div', { class: 'copied' });
  let text = '',
    text_now: ((model: Model) => string) | null = null;
  const buttons = Object.entries({ ...kCopies, link }).map(([name, text_of]) =>
    button(name, () => {
      text = text_of(model);
      text_now = text_of;
      shown.replaceChildren(code_block(text, `the ${name}`));
    }),
  );
  return {
    element: section('copies', 'Copy as', h('div', { class: 'chips' }, buttons), shown),
    // Hides the text if it is out of date.
    update: () => {
      if (!text_now || text_now(model) === text) return;
      shown.replaceChildren();
      text_now = null;
    },
  };
}
