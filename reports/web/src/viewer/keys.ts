// SPDX-License-Identifier: Apache-2.0
// All keys, and the help that lists them.
import { h, paragraph, table_row } from '../dom';

// keys: as in KeyboardEvent.key, without Shift and Alt; shown: for readers. of_2012: whether the thesis's viewer had
// the key.
export interface Key {
  keys: string[];
  shown: string;
  does: string;
  of_2012?: boolean;
  on_board?: boolean;
  with_control?: string;
  press: (event: KeyboardEvent) => void;
}

const kTyping = 'input:not([type=range]):not([type=checkbox]), textarea, select';
const kPressed = 'button, summary, a, input'; // elements that use Enter, space and arrows themselves

// The key's own name, independent of Shift and Alt.
const base = (event: KeyboardEvent) =>
  ({ BracketLeft: '[', BracketRight: ']' })[event.code] ??
  (event.key.length === 1 ? event.key.toLowerCase() : event.key);

export function keys(all: Key[], active: () => boolean) {
  const table = (rows: Key[]) =>
    rows.map(({ shown, does }) =>
      table_row(
        shown.split(' ').map((key, i) => [i ? ' ' : '', h('kbd', {}, key)]),
        h('td', {}, does),
      ),
    );
  const on = h('input', { type: 'checkbox', checked: true });
  const help = h(
    'dialog',
    { id: 'help', 'aria-labelledby': 'help-title' },
    h('form', { method: 'dialog', class: 'close' }, h('button', {}, 'Close')),
    h('h2', { id: 'help-title', tabindex: -1 }, 'Keys'),
    paragraph(
      'Drag a vertex with mouse or finger to move it, with Shift for fine steps. Drag the background to turn the drawing. Keys work wherever the page has the focus, except in fields. Arrow keys and space work only in the drawing.',
    ),
    h(
      'table',
      { class: 'plain' },
      h(
        'tbody',
        {},
        h('tr', {}, h('th', { colspan: 2, scope: 'colgroup' }, 'As in 2012')),
        table(all.filter((key) => key.of_2012)),
        h('tr', {}, h('th', { colspan: 2, scope: 'colgroup' }, 'New')),
        table(all.filter((key) => !key.of_2012)),
      ),
    ),
    h('label', {}, on, ' single-letter keys are active'),
  );
  document.addEventListener('keydown', (event) => {
    if (!active() || event.defaultPrevented) return;
    const target = event.target as Element,
      name = base(event),
      control = event.ctrlKey || event.metaKey;
    const found = all.find((key) =>
      control ? key.with_control === (event.shiftKey && name === 'z' ? 'y' : name) : key.keys.includes(name),
    );
    if (!found || target.matches(kTyping) || (help.open && name !== 'h')) return;
    if (found.on_board && (target.matches(kPressed) || !target.matches('body, .board'))) return;
    if (name.length === 1 && name !== 'h' && !control && !on.checked) return;
    event.preventDefault();
    found.press(event);
  });
  const toggle = () => {
    if (help.open) return help.close();
    help.showModal();
    help.querySelector('h2')!.focus();
    help.scrollTop = 0;
  };
  return { help, toggle };
}
