// SPDX-License-Identifier: Apache-2.0
// A table that sorts by any column and shows its rows in pages. Arrow keys move between its cells.
import { button, h, type Child } from './dom';
import { count } from './format';

export interface Column<Row> {
  label: string;
  title?: string;
  numeric?: boolean;
  heading?: Child[]; // shown instead of the label
  cell: (row: Row) => HTMLTableCellElement | Child;
  order: (row: Row) => number | string; // sort key
  descending_first?: boolean;
}

export interface Table<Row> {
  element: HTMLElement;
  show: (rows: Row[]) => void;
  columns: (columns: Column<Row>[]) => void;
}

// A column of counts; undefined means that the count is not known.
export const counts = <Row>(label: string, of: (row: Row) => number | undefined): Column<Row> => ({
  label,
  numeric: true,
  cell: (row) => (of(row) === undefined ? '–' : count(of(row)!)),
  order: (row) => of(row) ?? -1,
});

interface Options {
  caption: string;
  class?: string;
  page?: number; // rows shown at first; a button adds the same number
  walk?: boolean; // whether the arrow keys move the focus between cells; the whole table is one tab stop
}

export function sortable_table<Row>(columns: Column<Row>[], options: Options): Table<Row> {
  const head = h('tr', {}),
    body = h('tbody', {});
  const table = h(
    'table',
    { class: options.class ?? '' },
    h('caption', {}, options.caption),
    h('thead', {}, head),
    body,
  );
  const scroller = h('div', { class: 'scroller', role: 'region', 'aria-label': options.caption, tabindex: 0 }, table);
  const show_more = () => {
    limit += options.page ?? 0;
    draw_body();
  };
  const more = button('', show_more, { class: 'more' });
  const element = h('div', { class: 'sortable' }, scroller, more);
  let rows: Row[] = [],
    sorted: Row[] = [],
    by = -1,
    descending = false,
    limit = options.page ?? Infinity;

  function sort() {
    sorted = [...rows];
    if (by < 0) return;
    const { order } = columns[by];
    const sign = descending ? -1 : 1;
    const keys = new Map(rows.map((row) => [row, order(row)]));
    sorted.sort((x, y) => {
      const a = keys.get(x)!,
        b = keys.get(y)!;
      return sign * (a < b ? -1 : a > b ? 1 : 0);
    });
  }

  function draw_head() {
    head.replaceChildren(
      ...columns.map((column, i) => {
        const state = i !== by ? 'none' : descending ? 'descending' : 'ascending';
        const press = () => {
          if (by === i) descending = !descending;
          else [by, descending] = [i, column.descending_first ?? column.numeric ?? false];
          draw();
          (head.children[i].firstElementChild as HTMLElement).focus();
        };
        const title = [column.heading ?? column.label, h('span', { class: 'arrow', 'aria-hidden': 'true' }, '')];
        return h(
          'th',
          { scope: 'col', 'aria-sort': state, class: column.numeric ? 'number' : '' },
          button(title, press, { title: column.title ?? `Sort by ${column.label}` }),
        );
      }),
    );
  }

  function draw_body() {
    const shown = sorted.slice(0, limit);
    body.replaceChildren(
      ...shown.map((row) =>
        h(
          'tr',
          {},
          ...columns.map((column, i) => {
            const cell = column.cell(row);
            const made =
              cell instanceof HTMLTableCellElement
                ? cell
                : h(
                    i === 0 ? 'th' : 'td',
                    { scope: i === 0 ? 'row' : null, class: column.numeric ? 'number' : null },
                    cell,
                  );
            if (options.walk && i > 0) made.tabIndex = -1;
            return made;
          }),
        ),
      ),
    );
    if (!shown.length)
      body.append(h('tr', {}, h('td', { colspan: columns.length, class: 'empty' }, 'Nothing passes the filter.')));
    else if (options.walk) (body.rows[0].cells[1] ?? body.rows[0].cells[0]).tabIndex = 0;
    more.hidden = sorted.length <= limit;
    more.textContent = `Show ${Math.min(options.page ?? 0, sorted.length - limit)} more of ${sorted.length - limit}`;
  }

  function draw() {
    sort();
    draw_head();
    draw_body();
  }

  if (options.walk)
    body.addEventListener('keydown', (event) => {
      const step = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] }[event.key];
      const from = (event.target as Element).closest('td');
      if (!step || !from) return;
      event.preventDefault();
      const to =
        body.rows[(from.parentElement as HTMLTableRowElement).sectionRowIndex + step[0]]?.cells[
          from.cellIndex + step[1]
        ];
      if (!(to instanceof HTMLTableCellElement) || to.cellIndex === 0) return;
      from.tabIndex = -1;
      to.tabIndex = 0;
      to.focus();
    });

  return {
    element,
    show(next) {
      rows = next;
      limit = options.page ?? Infinity;
      draw();
    },
    columns(next) {
      columns = next;
      if (by >= columns.length) by = -1;
      draw();
    },
  };
}

// A table whose rows do not change.
export function table_of<Row>(columns: Column<Row>[], rows: Row[], options: Options): HTMLElement {
  const table = sortable_table(columns, options);
  table.show(rows);
  return table.element;
}
