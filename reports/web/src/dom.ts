// SPDX-License-Identifier: Apache-2.0
// Creates elements, and small components that several sections share.

export type Child = Node | string | null | false | Child[];
type Props = Record<string, string | number | boolean | null | ((event: never) => void)>;

// Creates an element. Functions become listeners (`onclick`), and true becomes an attribute without a value. Properties
// that are false or null are omitted.
export function h<K extends keyof HTMLElementTagNameMap>(tag: K, props: Props, ...children: Child[]) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(props)) {
    if (typeof value === 'function') element.addEventListener(name.slice(2), value as EventListener);
    else if (value === true) element.setAttribute(name, '');
    else if (value !== false && value !== null) element.setAttribute(name, String(value));
  }
  append(element, children);
  return element;
}

function append(element: Element, children: Child[]) {
  for (const child of children) {
    if (Array.isArray(child)) append(element, child);
    else if (child !== false && child !== null) element.append(child);
  }
}

// Creates a button that calls `press`.
export const button = (content: Child, press: (event: Event) => unknown, props: Props = {}) =>
  h('button', { type: 'button', ...props, onclick: press }, content);

// A paragraph of text.
export const paragraph = (...children: Child[]) => h('p', {}, ...children);

export const list = (items: Child[], props: Props = {}) =>
  h(
    'ul',
    props,
    items.map((item) => h('li', {}, item)),
  );

// A table. An empty title gives an empty cell instead of a header.
export const table = (name: string, caption: string | null, titles: Child[], rows: Child[]) =>
  h(
    'table',
    { class: name },
    caption !== null && h('caption', {}, caption),
    h(
      'thead',
      {},
      h(
        'tr',
        {},
        titles.map((title) => (title === '' ? h('td', {}) : h('th', { scope: 'col' }, title))),
      ),
    ),
    h('tbody', {}, rows),
  );

export const table_row = (name: Child, ...cells: Child[]) => h('tr', {}, h('th', { scope: 'row' }, name), cells);

// Contents that scroll sideways if they are too wide for the page.
export const scroller = (label: string, ...contents: Child[]) =>
  h('div', { class: 'scroller', tabindex: 0, role: 'group', 'aria-label': label }, contents);

export function section(id: string, title: string, ...children: Child[]) {
  return h('section', { id, 'aria-labelledby': `${id}-title` }, h('h2', { id: `${id}-title` }, title), ...children);
}

// An identifier with an optional line break after each underscore and slash.
export function breakable(id: string): Child[] {
  return id.split(/(?<=[_/])/).flatMap((part, i) => (i ? [h('wbr', {}), part] : [part]));
}

// A sentence in which text between backticks becomes code.
export function sentence(text: string): Child[] {
  return text.split('`').map((part, i) => (i % 2 ? h('code', {}, part) : part));
}

// A text of this page with markup: `code`, **strong**, *emphasised*.
export const marked = (text: string): Child[] =>
  text
    .split(/(`.*?`|\*\*.*?\*\*|\*.*?\*)/)
    .map((part, i) =>
      i % 2 === 0
        ? part
        : part[0] === '`'
          ? h('code', {}, part.slice(1, -1))
          : part[1] === '*'
            ? h('strong', {}, part.slice(2, -2))
            : h('i', {}, part.slice(1, -1)),
    );

async function to_clipboard(text: string) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    // some browsers have no clipboard here, because they do not consider a file on disk a secure context
    const area = h('textarea', { class: 'hidden' });
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand('copy');
    area.remove();
  }
}

export function copy_button(text: string, what: string) {
  const press = async () => {
    await to_clipboard(text);
    copy.textContent = 'Copied';
    setTimeout(() => (copy.textContent = 'Copy'), 1500);
  };
  const copy = button('Copy', press, { class: 'copy', 'aria-label': `Copy ${what}` });
  return copy;
}

// Shows a text with a copy button. Long lines scroll.
export function code_block(text: string, what: string) {
  return h(
    'div',
    { class: 'code' },
    h('pre', { tabindex: 0, 'aria-label': what }, h('code', {}, text)),
    copy_button(text, what),
  );
}

// A <details> whose contents are made when it is first opened.
export function lazy_details(summary: Child[], make: () => Child, props: Props = {}) {
  const details = h('details', props, h('summary', {}, ...summary));
  let made = false;
  const open = () => {
    if (made || !details.open) return;
    made = true;
    append(details, [make()]);
  };
  details.addEventListener('toggle', open);
  return { details, open: () => ((details.open = true), open()) };
}

// A <details> below a section's main contents.
export const more_facts = (title: string, make: () => Child) =>
  lazy_details([title], make, { class: 'more-facts' }).details;

// A labelled <select> that calls `change` with the chosen value.
export function choice(label: string, options: [string, string][], value: string, change: (value: string) => void) {
  const select = h(
    'select',
    { onchange: () => change(select.value) },
    options.map(([id, text]) => h('option', { value: id, selected: id === value }, text)),
  );
  return h('label', { class: 'field' }, h('span', {}, label), select);
}

// Calls draw(width) soon, and after each change of the element's width.   Returns: a function that redraws now, if the
// element is shown.
export function on_width(element: HTMLElement, draw: (width: number) => void) {
  let last = 0;
  new ResizeObserver(() => {
    const width = Math.floor(element.clientWidth);
    if (width > 0 && width !== last) draw((last = width));
  }).observe(element);
  return () => element.clientWidth && draw(element.clientWidth);
}
