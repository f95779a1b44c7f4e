// SPDX-License-Identifier: Apache-2.0
// Compares two lanes of one algorithm: the effects of the compiler's contraction and of the precision.
import { series_colour } from './chart';
import { choice, h, on_width, paragraph, section } from './dom';
import { in_full, percent } from './format';
import { heat_class } from './heat';
import { lane_picker } from './lane_picker';
import { margin_chart } from './margin_chart';
import type { Report, Share } from './report';
import { sortable_table } from './sortable_table';

type Side = Report['side_by_side'][number];

const kKinds: { kind: Side['kind']; title: string; says: string }[] = [
  {
    kind: 'cpu-nofma',
    title: 'CPU against CUDA without contraction',
    says: 'Both lanes round every operation, so their verdicts must be equal on every pair.',
  },
  {
    kind: 'nofma-fma',
    title: 'CUDA without and with contraction',
    says: 'Both lanes have the same source. nvcc fuses products into additions, unless -fmad=false forbids that.',
  },
  {
    kind: 'f32-f64',
    title: 'float32 against float64',
    says: 'Both lanes have the same source and target, but a different precision.',
  },
];

function share_cell(share: Share) {
  return h('td', { class: `number ${heat_class(share.share)}`, title: in_full(share) }, percent(share.share));
}

function differs_cell(differs: Share | null, must_be_equal: boolean) {
  if (!differs) return h('td', { class: 'number', title: 'Not counted pair by pair' }, '–');
  const equal = differs.count === 0;
  return h(
    'td',
    { class: `number ${must_be_equal ? (equal ? 'good' : 'bad') : ''}`, title: in_full(differs) },
    equal ? (must_be_equal ? '✓ equal' : '0') : `${must_be_equal ? '✗ ' : ''}${percent(differs.share)}`,
  );
}

// The common part of the two lanes' names.
const common = (report: Report, side: Side) => {
  const [left, right] = [report.lanes[side.left], report.lanes[side.right]];
  return side.kind === 'f32-f64' ? `${left.algorithm}, ${left.target}` : `${left.algorithm}/${right.scalar}`;
};

// A chart of how often lanes differ from their cpu lane, against the margin.
function by_margin(report: Report) {
  const compared = report.margins.filter((row) => row.points.some((p) => p.differs));
  if (!compared.length) return null;
  const differ = compared.filter((row) => row.points.some((p) => p.differs?.count));
  const targets = [...new Set((differ.length ? differ : compared).map((row) => report.lanes[row.lane].target))];
  const element = h('figure', { class: 'chart', id: 'differ-chart' });
  const chart = margin_chart(
    report,
    element,
    'differs',
    {
      title: 'Share of verdicts that differ from the cpu lane’s, against the exact margin, all strata',
      label: 'share that differs from cpu',
      word: 'different',
    },
    () => picker.lanes(),
    () => true,
  );
  const picker = lane_picker(
    report,
    'differ',
    { scalar: ['f32'], target: targets.includes('cuda-fma') ? ['cuda-fma'] : targets },
    on_width(element, chart.draw),
    (algorithm) => series_colour(report, algorithm),
  );
  return [
    h('h3', {}, 'At which margins do lanes differ from the cpu lane?'),
    paragraph(
      'The chart shows how often a lane’s verdict differs from that of the cpu lane of its algorithm and precision, against the exact margin. CUDA without contraction has the same verdicts as cpu, so the curves of CUDA with contraction compare with both. f32 and f64 are not compared pair by pair.',
    ),
    picker.element,
    element,
  ];
}

export function side_by_side_section(report: Report) {
  let stratum: number | null = null;
  const of = (side: Side) => side.strata.find((entry) => entry.stratum === stratum);
  const tables = kKinds.flatMap(({ kind, title, says }) => {
    const rows = report.side_by_side.filter((side) => side.kind === kind);
    if (!rows.length) return [];
    const own = (lane: number) => report.lanes[lane][kind === 'f32-f64' ? 'scalar' : 'target'];
    const equal = kind === 'cpu-nofma';
    const measured = rows.some((side) => side.strata.some((entry) => entry.differs));
    const table = sortable_table<Side>(
      [
        { label: 'Algorithm', cell: (side) => common(report, side), order: (side) => rows.indexOf(side) },
        ...(['left', 'right'] as const).map((which) => ({
          label: `${own(rows[0][which])}, wrong`,
          numeric: true,
          cell: (side: Side) => {
            const s = of(side);
            return s ? share_cell(s[`${which}_wrong`]) : '–';
          },
          order: (side: Side) => of(side)?.[`${which}_wrong`].share ?? -1,
        })),
        ...(measured
          ? [
              {
                label: 'Differ',
                title: 'Pairs on which the two lanes have different verdicts',
                numeric: true,
                cell: (side: Side) => differs_cell(of(side)?.differs ?? null, equal),
                order: (side: Side) => of(side)?.differs?.share ?? -1,
              },
            ]
          : []),
      ],
      { caption: title, class: 'plain beside' },
    );
    const show = () => table.show(rows);
    show();
    return [{ show, element: h('div', { class: 'beside-one' }, h('h3', {}, title), paragraph(says), table.element) }];
  });
  if (!tables.length) return null;
  const options: [string, string][] = [
    ['', 'all'],
    ...report.strata.map((s, i): [string, string] => [String(i), s.id]),
  ];
  return section(
    'side-by-side',
    'Side by side',
    h(
      'div',
      { class: 'controls' },
      choice('Stratum', options, '', (value) => {
        stratum = value === '' ? null : Number(value);
        tables.forEach(({ show }) => show());
      }),
    ),
    h(
      'div',
      { class: 'beside-all' },
      tables.map(({ element }) => element),
    ),
    by_margin(report),
  );
}
