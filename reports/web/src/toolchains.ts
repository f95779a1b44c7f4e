// SPDX-License-Identifier: Apache-2.0
// How the verdicts of each algorithm change with the compiler and the processor.
import { breakable, choice, h, list, paragraph, section, sentence } from './dom';
import { in_full, percent } from './format';
import { heat_class } from './heat';
import type { Report, ToolchainMap } from './report';
import { sortable_table } from './sortable_table';

type Row = ToolchainMap['rows'][number];

export function toolchains_section(report: Report) {
  const map = report.toolchains;
  if (!map) return null;
  let shown: 'differs' | 'wrong' = 'differs';
  const share_of = (row: Row, variant: number) => row.cells.find((cell) => cell.variant === variant)?.[shown];
  const table = sortable_table<Row>(
    [
      {
        label: 'Algorithm',
        cell: (row) => breakable(`${row.algorithm}/${row.scalar}`),
        order: (row) => map.rows.indexOf(row),
      },
      ...map.variants.map((label, variant) => ({
        label,
        numeric: true,
        cell: (row: Row) => {
          const share = share_of(row, variant);
          if (!share) return h('td', { class: 'number', title: 'Not counted, or no such lane' }, '–');
          return h(
            'td',
            { class: `number ${heat_class(share.share)}`, title: in_full(share) },
            share.count ? percent(share.share) : '0',
          );
        },
        order: (row: Row) => share_of(row, variant)?.share ?? -1,
      })),
    ],
    { caption: 'Verdicts by algorithm and toolchain', class: 'plain' },
  );
  table.show(map.rows);
  const options: [string, string][] = [
    ['differs', `differ from ${map.reference}’s`],
    ['wrong', 'are wrong'],
  ];
  return section(
    'toolchains',
    'Toolchains',
    paragraph('Each toolchain compiles the same source for its processor. The cpu and cuda lanes are from this build.'),
    list(map.sentences.map(sentence)),
    h(
      'div',
      { class: 'controls' },
      choice('Verdicts that', options, 'differs', (value) => {
        shown = value === 'wrong' ? 'wrong' : 'differs';
        table.show(map.rows);
      }),
    ),
    table.element,
  );
}
