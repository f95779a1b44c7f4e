// SPDX-License-Identifier: Apache-2.0
// Heat maps of the error rate by the size of the coordinates, and by a pair's distance from the origin.
import * as Plot from '@observablehq/plot';
import { kChartStyle, named } from './chart';
import { h, lazy_details, on_width, section } from './dom';
import { in_full, percent, power_of_two } from './format';
import { heat_fill, heat_legend } from './heat';
import { lane_picker, type Picker } from './lane_picker';
import type { Report, Share } from './report';
import { sortable_table } from './sortable_table';

type Kind = Report['extremes'][number]['kind'];
interface Cell {
  lane: number;
  name: string;
  from: number;
  to: number;
  wrong: Share;
  words: string;
}

// A cell with fewer pairs is drawn as a line, because its rate may be due to chance.
const kFew = 100;
const few = ({ wrong }: Cell) => wrong.of < kFew;

const kKinds: { kind: Kind; title: string; says: string; axis: string; short: string; what: string }[] = [
  {
    kind: 'scale',
    title: 'Size of the coordinates',
    axis: 'largest coordinate',
    short: 'largest coordinate',
    what: 'largest coordinate',
    says: 'By the largest coordinate’s power of two, from the smallest subnormal float32 to the largest number: products underflow to the left and overflow to the right.',
  },
  {
    kind: 'offset',
    title: 'Distance from the origin',
    axis: 'largest coordinate, in sizes of the pair',
    short: 'largest coordinate / size',
    what: 'offset',
    says: 'By how many times its own size a pair lies away from the origin: every doubling costs a bit of what float32 has left for its shape.',
  },
];

function cells_of(report: Report, kind: Kind, lanes: number[]): Cell[] {
  const what = kKinds.find((k) => k.kind === kind)!.what;
  return report.extremes
    .filter((row) => row.kind === kind && lanes.includes(row.lane))
    .flatMap((row) =>
      row.cells.map((cell) => {
        const [from, to] = [cell.exponent, cell.exponent + (row.step ?? 1)];
        return {
          lane: row.lane,
          name: report.lanes[row.lane].id,
          from,
          to,
          wrong: cell.wrong,
          words: `${report.lanes[row.lane].id}\n${what} ${power_of_two(from)} to ${power_of_two(to)}\n${in_full(cell.wrong)}`,
        };
      }),
    );
}

export function extremes_section(report: Report) {
  const kinds = kKinds.filter(({ kind }) => report.extremes.some((row) => row.kind === kind && row.cells.length));
  if (!kinds.length) return null;
  const figures = kinds.map((kind) => ({
    ...kind,
    element: h('figure', { class: 'chart heat', id: `extremes-${kind.kind}` }),
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
      width,
      height: lanes.length * (small ? 34 : 24) + 66,
      marginLeft: small ? 4 : 210,
      marginRight: 14,
      marginTop: 8,
      marginBottom: 46,
      style: kChartStyle,
      x: {
        domain: [from, to],
        ticks,
        tickFormat: power_of_two,
        label: small ? short : axis,
        labelAnchor: 'center',
        labelArrow: 'none',
        labelOffset: 40,
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
              fill: (c: Cell) => heat_fill(c.wrong.share),
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
      const worst = cells
        .filter((c) => c.name === name && !few(c))
        .reduce<Cell | null>((most, c) => (c.wrong.share > (most?.wrong.share ?? 0) ? c : most), null);
      return worst
        ? `${name}: at most ${percent(worst.wrong.share)}, from ${power_of_two(worst.from)} on`
        : `${name}: none wrong`;
    };
    const label = `${title}: heat map of the share of wrong verdicts, cells of ${kFew} pairs and more. ${lanes.map(lane_words).join('. ')}. As a table below`;
    element.replaceChildren(cells.length ? named(plot, label) : h('p', { class: 'empty' }, 'No lane is chosen.'));
  }

  const redraw = () => figures.forEach((one) => one.element.clientWidth && draw(one, one.element.clientWidth));
  const picker: Picker = lane_picker(report, 'extremes', { target: ['cpu'] }, redraw);
  figures.forEach((one) => on_width(one.element, (width) => draw(one, width)));
  return section(
    'extremes',
    'Extremes',
    h(
      'p',
      {},
      'Where numbers are very large, very small, or far from the origin. Blank: no pair of the campaign lies there. ',
      h('b', {}, 'A thin cell'),
      ` has fewer than ${kFew} pairs, so chance may have coloured it.`,
    ),
    picker.element,
    heat_legend(),
    figures.map(({ kind, title, says, element }) => [
      h('div', { class: 'kept' }, h('h3', {}, title), h('p', {}, says), element),
      lazy_details(
        ['The numbers as a table'],
        () => {
          const table = sortable_table<Cell>(
            [
              { label: 'Lane', cell: (c) => c.name, order: (c) => c.lane },
              { label: 'From', numeric: true, cell: (c) => power_of_two(c.from), order: (c) => c.from },
              { label: 'Wrong', numeric: true, cell: (c) => percent(c.wrong.share), order: (c) => c.wrong.share },
              { label: 'In full', cell: (c) => in_full(c.wrong), order: (c) => c.wrong.count },
            ],
            { caption: `${title}, of the lanes chosen when this was opened`, class: 'plain', page: 100 },
          );
          table.show(cells_of(report, kind, picker.lanes()));
          return table.element;
        },
        { class: 'more-facts' },
      ).details,
    ]),
  );
}
