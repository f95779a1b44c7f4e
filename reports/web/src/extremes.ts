// SPDX-License-Identifier: Apache-2.0
// Heat maps over the size of the coordinates and over a pair's distance from the origin. A cell shows the ratio of a
// lane's error rate there to its rate on the pairs nearest to 2^0. A table with sentences also covers flat triangles
// and needles, which `graze pareto` measures.
import * as Plot from '@observablehq/plot';
import { frame, named, x_label } from './chart';
import { breakable, h, more_facts, on_width, paragraph, section } from './dom';
import { figure, in_full, percent, power_of_two } from './format';
import { times_fill, times_legend } from './heat';
import { lane_picker, type Picker } from './lane_picker';
import type { Pareto, Report, Share, Times } from './report';
import { sortable_table, table_of } from './sortable_table';

type Kind = Report['extremes'][number]['kind'];
interface Cell {
  lane: number;
  name: string;
  from: number;
  to: number;
  wrong: Share;
  times: Times;
  words: string;
}

// Without errors at the origin, only the lower bound of the ratio is known.
const shown = ([share, low]: Times) => share ?? low;
const ratio = ({ times }: Cell) => `${times[0] === null ? 'at least ' : ''}${figure(shown(times))} ×`;
const bounds = ([, low, high]: Times) =>
  high === null ? `95 %: ${figure(low)} and more` : `95 %: ${figure(low)} to ${figure(high)}`;

// A cell with fewer pairs than this is drawn thin, because its rate may be due to chance.
const kFew = 100;
const few = ({ wrong }: Cell) => wrong.of < kFew;

const kScale = { axis: 'largest coordinate', short: 'largest coordinate', what: 'largest coordinate' };
const kOffset = {
  axis: 'largest coordinate / size of the pair',
  short: 'largest coordinate / size',
  what: 'offset',
};
const kKinds: { kind: Kind; column: string; title: string; says: string; axis: string; short: string; what: string }[] =
  [
    {
      kind: 'scale',
      column: 'Scaled',
      title: 'Size of the coordinates',
      ...kScale,
      says: 'Columns: the power of two of the largest coordinate, from the smallest subnormal float32 to the largest float32. Products underflow on the left and overflow on the right.',
    },
    {
      kind: 'offset',
      column: 'Away from the origin',
      title: 'Distance from the origin',
      ...kOffset,
      says: 'Columns: a pair’s distance from the origin, in multiples of its own size. Each doubling leaves float32 one bit less for the pair’s shape.',
    },
    {
      kind: 'scale/f64',
      column: 'Doubles scaled',
      title: 'Size of the coordinates of doubles',
      ...kScale,
      says: 'Pairs of doubles. Columns: the power of two of the largest coordinate. Lanes in float32 decide the pair as float32 stores it, and float32 ends at 2^128.',
    },
    {
      kind: 'offset/f64',
      column: 'Doubles away from the origin',
      title: 'Distance of doubles from the origin',
      ...kOffset,
      says: 'Pairs of doubles. Columns: a pair’s distance from the origin, in multiples of its own size.',
    },
  ];

const drawn_kinds = (report: Report) =>
  kKinds.filter(({ kind }) => report.extremes.some((row) => row.kind === kind && row.cells.length));

function cells_of(report: Report, kind: Kind, lanes: number[]): Cell[] {
  const what = kKinds.find((k) => k.kind === kind)!.what;
  return report.extremes
    .filter((row) => row.kind === kind && lanes.includes(row.lane))
    .flatMap((row) =>
      row.cells.map((cell) => {
        const [from, to] = [cell.exponent, cell.exponent + (row.step ?? 1)];
        const found = {
          lane: row.lane,
          name: report.lanes[row.lane].id,
          from,
          to,
          wrong: cell.wrong,
          times: cell.times ?? [0, 0, 0],
        } as Cell;
        found.words = `${found.name}\n${what} ${power_of_two(from)} to ${power_of_two(to)}\n${in_full(cell.wrong)}${cell.times ? `\n${ratio(found)} as often as at the origin (${bounds(cell.times)})` : ''}`;
        return found;
      }),
    );
}

// A table with a row for each lane. Its cells are texts from the campaign's report and from pareto.json.
function words_table(report: Report, pareto: Pareto | null, lanes: number[]) {
  const said = (lane: number, kind: Kind) =>
    report.extremes.find((row) => row.lane === lane && row.kind === kind)?.says ?? 'no pairs';
  const measured = (lane: number, extreme: string) =>
    pareto?.extremes.find((row) => row.lane === report.lanes[lane].id && row.extreme === extreme)?.says ?? '–';
  const column = (label: string, words: (lane: number) => string) => ({ label, cell: words, order: words });
  const table = sortable_table<number>(
    [
      { label: 'Lane', cell: (lane) => breakable(report.lanes[lane].id), order: (lane) => lane },
      ...drawn_kinds(report).map((of) => column(of.column, (lane) => said(lane, of.kind))),
      ...(pareto
        ? [
            column('Flattened by 2^k', (lane) => measured(lane, 'flatness')),
            column('Narrowed by 2^k', (lane) => measured(lane, 'aspect')),
          ]
        : []),
    ],
    { caption: 'Ranges in which the chosen lanes are as right as on ordinary pairs', class: 'plain reach' },
  );
  table.show(lanes);
  return table;
}

export function extremes_section(report: Report, pareto: Pareto | null) {
  const kinds = drawn_kinds(report);
  if (!kinds.length) return null;
  const figures = kinds.map((kind) => ({
    ...kind,
    element: h('figure', { class: 'chart heat', id: `extremes-${kind.kind.replace('/', '-')}` }),
  }));

  function draw({ kind, axis, short, title, element }: (typeof figures)[number], width: number) {
    const cells = cells_of(report, kind, picker.lanes());
    const small = width < 640;
    const lanes = [...new Set(cells.map((cell) => cell.name))];
    const from = Math.min(...cells.map((c) => c.from)),
      to = Math.max(...cells.map((c) => c.to));
    const every = [1, 2, 4, 8, 16, 32, 64].find((step) => ((to - from) / step) * 46 < width - (small ? 0 : 210)) ?? 64;
    const ticks: number[] = [];
    for (let e = Math.ceil(from / every) * every; e <= to; e += every) ticks.push(e);
    const plot = Plot.plot({
      ...frame(width, lanes.length * (small ? 34 : 24) + 66, [8, 14, 46, small ? 4 : 210]),
      x: {
        domain: [from, to],
        ticks,
        tickFormat: power_of_two,
        ...x_label(small ? short : axis, 40),
      },
      y: { domain: lanes, label: null, padding: 0.12, axis: small ? null : 'left', tickSize: 0 },
      marks: [
        ...[false, true].map((thin) =>
          Plot.rect(
            cells.filter((c) => few(c) === thin),
            {
              x1: 'from',
              x2: 'to',
              y: 'name',
              fill: (c: Cell) => times_fill(shown(c.times)),
              insetTop: (small ? 15 : 0) + (thin ? 8 : 0),
              insetBottom: thin ? (small ? 2 : 8) : 0,
              shapeRendering: 'crispEdges',
              className: thin ? 'few' : 'many',
            },
          ),
        ),
        ...(small
          ? [
              Plot.text(lanes, {
                y: (name: string) => name,
                x: from,
                text: (name: string) => name,
                textAnchor: 'start',
                dy: -8,
                fontSize: 11,
              }),
            ]
          : []),
        Plot.tip(
          cells,
          Plot.pointer({ x: (c: Cell) => (c.from + c.to) / 2, y: 'name', title: 'words', maxRadius: 30 }),
        ),
      ],
    });
    const lane_words = (name: string) => {
      const row = report.extremes.find((one) => one.kind === kind && report.lanes[one.lane].id === name)!;
      return `${name}: ${row.says}`;
    };
    const label = `${title}: a heat map of how many times as often lanes are wrong as at the origin. ${lanes.map(lane_words).join('. ')}. A table below has the numbers`;
    element.replaceChildren(cells.length ? named(plot, label) : h('p', { class: 'empty' }, 'No lane is chosen.'));
  }

  const draw_again = figures.map((one) => on_width(one.element, (width) => draw(one, width)));
  const redraw = () => {
    draw_again.forEach((again) => again());
    words.show(picker.lanes());
  };
  const picker: Picker = lane_picker(report, 'extremes', { target: ['cpu'] }, redraw);
  const words = words_table(report, pareto, picker.lanes());
  return section(
    'extremes',
    'Extremes',
    paragraph(
      'The maps show pairs that are very large, very small or far from the origin. The colour of a cell shows how many times as often a lane is wrong there as on the pairs nearest to 2⁰, the origin of the map. Near contacts are hard at every scale, so the share of errors alone would say little. The campaign has no pairs in a blank cell. ',
      h('b', {}, 'A thin cell'),
      ` has fewer than ${kFew} pairs, so chance may have coloured it.`,
    ),
    picker.element,
    paragraph(
      '“As right” means that the lane errs on at most twice the share of pairs, or on at most 0.1 %, with 95 % confidence.',
      pareto
        ? ''
        : ' To measure flat triangles and needles too, run graze pareto with --out and the campaign’s folder.',
    ),
    words.element,
    times_legend(),
    figures.map(({ kind, title, says, element }) => [
      h('div', { class: 'kept' }, h('h3', {}, title), paragraph(says), element),
      more_facts('The numbers as a table', () =>
        table_of<Cell>(
          [
            { label: 'Lane', cell: (c) => c.name, order: (c) => c.lane },
            { label: 'From', numeric: true, cell: (c) => power_of_two(c.from), order: (c) => c.from },
            { label: 'Wrong', numeric: true, cell: (c) => percent(c.wrong.share), order: (c) => c.wrong.share },
            { label: 'Times the origin', numeric: true, cell: ratio, order: (c) => shown(c.times) },
            { label: 'In full', cell: (c) => in_full(c.wrong), order: (c) => c.wrong.count },
          ],
          cells_of(report, kind, picker.lanes()),
          { caption: `${title}, for the lanes chosen when this was opened`, class: 'plain', page: 100 },
        ),
      ),
    ]),
  );
}
