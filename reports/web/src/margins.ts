// SPDX-License-Identifier: Apache-2.0
// Error against margin: the share of wrong verdicts by the exact margin in ulps, and the threshold from which no error
// was seen.
import * as Plot from '@observablehq/plot';
import { kChartStyle, named } from './chart';
import { breakable, choice, h, lazy_details, on_width, section } from './dom';
import { count, figure, in_full, percent, percent_bound, power_of_two } from './format';
import { lane_picker, type Picker } from './lane_picker';
import type { Report, Share, Threshold } from './report';
import { series_colour, series_dash, series_width } from './series';
import { sortable_table } from './sortable_table';
import { choose, chosen, when_chosen } from './state';

type Point = Report['margins'][number]['points'][number];
type Row = Report['thresholds'][number];
interface Dot {
  lane: number;
  x: number;
  share: Share;
  side: string;
  words: string;
}

const kNearest = -33; // below every exponent: position next to zero
const kGap = 3; // on both sides of the zero column

const kOutermost = [-32, 31]; // these buckets are open-ended

function bucket(exponent: number) {
  const [from, to] = [power_of_two(exponent), power_of_two(exponent + 1)];
  return exponent === kOutermost[0]
    ? `less than ${to} ulps`
    : exponent === kOutermost[1]
      ? `${from} ulps and more`
      : `${from} to ${to} ulps`;
}

function side_words({ side, exponent }: Point) {
  if (side === 'zero' || exponent === null) return 'touching or coplanar, margin 0';
  return side === 'disjoint' ? `${bucket(exponent)} apart` : `${bucket(exponent)} deep`;
}

// "2³", or the reason why there is none.
const from_words = ({ exponent, largest }: Threshold) =>
  exponent !== null ? power_of_two(exponent) : largest === null ? 'no such pairs' : `wrong at ${power_of_two(largest)}`;

export function margins_section(report: Report) {
  let log = chosen('share') !== 'linear';
  const exponents = report.margins.flatMap((row) =>
    row.points.flatMap((p) => (p.exponent === null || !p.wrong.of ? [] : [p.exponent])),
  );
  const some = exponents.length > 0 ? exponents : [0]; // if all pairs touch
  const lowest = Math.max(kNearest + 1, Math.min(...some)),
    highest = Math.max(...some);
  // Disjoint pairs are to the right of zero, intersecting ones to the left.
  const place = (side: string, exponent: number | null) =>
    exponent === null || side === 'zero' ? 0 : (side === 'disjoint' ? 1 : -1) * (exponent - lowest + kGap);
  const reach = highest - lowest + kGap + 1;
  const counted = report.margins.flatMap((row) => row.points.flatMap((p) => (p.wrong.count ? [p.wrong.share] : [])));
  const floor = Math.floor(Math.log10(Math.min(0.01, ...counted)));

  const figure_element = h('figure', { class: 'chart', id: 'margin-chart' });
  const thresholds = sortable_table<Row>(
    [
      { label: 'Lane', cell: (t) => breakable(report.lanes[t.lane].id), order: (t) => t.lane },
      ...(['disjoint', 'intersects'] as const).flatMap((side) => {
        const name = side === 'disjoint' ? 'apart' : 'deep';
        return [
          {
            label: `No error from (ulps ${name})`,
            numeric: true,
            cell: (t: Row) => from_words(t[side]),
            order: (t: Row) => t[side].exponent ?? 999,
          },
          {
            label: 'Pairs beyond',
            numeric: true,
            cell: (t: Row) => count(t[side].above),
            order: (t: Row) => t[side].above,
          },
          {
            label: 'Rate below (95 %)',
            numeric: true,
            cell: (t: Row) => (t[side].above ? percent_bound(t[side].bound, 'upper') : '–'),
            order: (t: Row) => t[side].bound,
          },
        ];
      }),
    ],
    { caption: 'Thresholds of the lanes chosen', class: 'plain thresholds' },
  );

  // The strata of a threshold: a group, one stratum, or all.
  const kinds: { id: string; label: string; is: (t: Row) => boolean }[] = [
    ...report.groups.map(({ id }, g) => ({ id, label: `${id} pairs`, is: (t: Row) => t.group === g })),
    { id: 'all', label: 'all strata together', is: (t: Row) => t.group === null && t.stratum === null },
    ...report.strata.map(({ id }, s) => ({ id: `stratum ${id}`, label: id, is: (t: Row) => t.stratum === s })),
  ];
  const kind = () => kinds.find(({ id }) => id === chosen('trust')) ?? kinds[0];
  const trust = choice(
    'Pairs',
    kinds.map(({ id, label }): [string, string] => [id, label]),
    kind().id,
    (value) => {
      choose('trust', value === kinds[0].id ? '' : value);
      show_thresholds();
    },
  );
  const describes = h('p', { class: 'key' });
  function show_thresholds() {
    trust.querySelector('select')!.value = kind().id;
    const group = report.groups.find(({ id }) => id === kind().id);
    describes.textContent = group
      ? `${group.id}: ${group.describes} (${group.strata.map((s) => report.strata[s].id).join(', ')}).`
      : '';
    thresholds.show(report.thresholds.filter((t) => kind().is(t) && picker.lanes().includes(t.lane)));
  }
  when_chosen(() => show_thresholds());

  function dots(): Dot[] {
    return picker
      .lanes()
      .flatMap((lane) => {
        const row = report.margins.find((r) => r.lane === lane);
        return (row?.points ?? [])
          .filter((p) => p.wrong.of > 0)
          .map((p) => ({
            lane,
            x: place(p.side, p.exponent) + (p.side === 'disjoint' ? 0.5 : p.side === 'intersects' ? -0.5 : 0),
            side: p.side,
            share: p.wrong,
            words: `${report.lanes[lane].id}\n${side_words(p)}\n${in_full(p.wrong)}`,
          }));
      })
      .sort((a, b) => a.x - b.x);
  }

  const pooled = (lane: number) =>
    report.thresholds.find((t) => t.lane === lane && t.group === null && t.stratum === null);
  const none = floor - 0.6; // position of a share of zero on the log axis
  const y = (share: number) => (!log ? 100 * share : share > 0 ? Math.max(none, Math.log10(share)) : none);

  function draw(width: number) {
    const all = dots(),
      small = width < 560;
    const ticks = [0];
    for (let e = Math.ceil((lowest + (small ? 8 : 0)) / 16) * 16; e <= highest; e += small ? 16 : 8)
      ticks.push(place('disjoint', e), place('intersects', e));
    const exponent_at = (x: number) => Math.abs(x) + lowest - kGap;
    const decades = Array.from({ length: -floor + 1 }, (_, i) => floor + i);
    const style = (lane: number) => report.lanes[lane];
    const lanes = [...new Set(all.map((dot) => dot.lane))];
    const marks: Plot.Markish[] = [
      Plot.ruleX([0], { stroke: 'currentColor', strokeOpacity: 0.12, strokeWidth: small ? 8 : 14 }),
      Plot.ruleY([log ? none : 0], { stroke: 'currentColor', strokeOpacity: 0.5 }),
    ];
    for (const lane of lanes) {
      const { algorithm, scalar, target } = style(lane);
      const stroke = series_colour(report, algorithm),
        dash = series_dash(target),
        strokeWidth = series_width(scalar);
      for (const side of ['intersects', 'disjoint']) {
        const own = all.filter((dot) => dot.lane === lane && dot.side === side);
        marks.push(
          Plot.areaY(own, {
            x: 'x',
            y1: (d: Dot) => y(d.share.low),
            y2: (d: Dot) => y(d.share.high),
            fill: stroke,
            fillOpacity: lanes.length > 6 ? 0.05 : lanes.length > 2 ? 0.08 : 0.18,
          }),
          Plot.lineY(own, {
            x: 'x',
            y: (d: Dot) => (log && !d.share.count ? NaN : y(d.share.share)),
            stroke,
            strokeWidth,
            strokeDasharray: dash,
            strokeLinejoin: 'round',
          }),
          Plot.dot(log ? own.filter((d) => !d.share.count) : [], { x: 'x', y: none, r: 1.6, fill: stroke }),
        );
      }
      const zero = all.filter((dot) => dot.lane === lane && dot.side === 'zero');
      marks.push(
        Plot.ruleX(zero, {
          x: 'x',
          y1: (d: Dot) => y(d.share.low),
          y2: (d: Dot) => y(d.share.high),
          stroke,
          strokeWidth,
        }),
        Plot.dot(zero, { x: 'x', y: (d: Dot) => y(d.share.share), fill: stroke, r: scalar === 'f64' ? 2.5 : 4 }),
      );
      const own = pooled(lane);
      const seen = (['disjoint', 'intersects'] as const).flatMap((side) => {
        const t = own?.[side];
        return t && t.exponent !== null && t.above
          ? [
              {
                x: place(side, t.exponent),
                words: `${report.lanes[lane].id}\nno error in ${count(t.above)} pairs from ${power_of_two(t.exponent)} ulps on\nrate below ${percent_bound(t.bound, 'upper')} (95 %)`,
              },
            ]
          : [];
      });
      marks.push(
        Plot.dot(seen, {
          x: 'x',
          y: log ? none : 0,
          symbol: 'triangle',
          r: 6,
          dy: 0,
          fill: stroke,
          stroke: 'var(--page)',
          title: 'words',
          className: 'threshold',
        }),
      );
    }
    marks.push(Plot.tip(all, Plot.pointer({ x: 'x', y: (d: Dot) => y(d.share.share), title: 'words', maxRadius: 30 })));
    const plot = Plot.plot({
      width,
      height: small ? 320 : 420,
      marginLeft: 58,
      marginRight: 12,
      marginBottom: 50,
      marginTop: 26,
      style: kChartStyle,
      x: {
        domain: [-reach, reach],
        ticks,
        tickFormat: (x: number) => (x === 0 ? '0' : power_of_two(exponent_at(x))),
        label: small
          ? 'margin, ulps: ← deep · apart →'
          : 'exact margin in ulps of the largest coordinate:  ← deeper inside  ·  farther apart →',
        labelAnchor: 'center',
        labelArrow: 'none',
        labelOffset: 42,
      },
      y: log
        ? {
            domain: [none, 0],
            grid: true,
            ticks: [none, ...decades],
            tickFormat: (v: number) => (v === none ? 'none' : `${figure(100 * 10 ** v)} %`),
            label: 'share wrong',
            labelArrow: 'none',
          }
        : {
            domain: [0, 100],
            grid: true,
            tickFormat: (v: number) => `${v} %`,
            label: 'share wrong',
            labelArrow: 'none',
          },
      marks,
    });
    const label = `Share of wrong verdicts against the exact margin, all strata. ${lanes.map(lane_words).join('. ')}`;
    figure_element.replaceChildren(
      all.length ? named(plot, label) : h('p', { class: 'empty' }, 'No lane is chosen, or it has no figures here.'),
    );
    show_thresholds();
  }

  // Describes a lane's curve in words: its worst margin, its share at margin 0, and the margins at which it is right.
  function lane_words(lane: number) {
    const points = (report.margins.find((row) => row.lane === lane)?.points ?? []).filter((p) => p.wrong.of > 0);
    const zero = points.find((p) => p.side === 'zero'),
      own = pooled(lane);
    const worst = points
      .filter((p) => p.side !== 'zero')
      .reduce<Point | null>((most, p) => (p.wrong.share > (most?.wrong.share ?? 0) ? p : most), null);
    const right = (['disjoint', 'intersects'] as const).map((side) =>
      own && own[side].exponent !== null
        ? `no error from ${power_of_two(own[side].exponent)} ulps ${side === 'disjoint' ? 'apart' : 'deep'}`
        : '',
    );
    return `${report.lanes[lane].id}: ${[
      zero && `wrong on ${percent(zero.wrong.share)} at margin 0`,
      worst ? `elsewhere at most ${percent(worst.wrong.share)}, ${side_words(worst)}` : 'elsewhere none wrong',
      ...right,
    ]
      .filter(Boolean)
      .join('; ')}`;
  }

  const redraw = () => figure_element.clientWidth && draw(figure_element.clientWidth);
  const published = [...new Set(report.lanes.filter((lane) => !lane.exact).map((lane) => lane.algorithm))];
  const picker: Picker = lane_picker(
    report,
    'margins',
    { algorithm: published, scalar: ['f32'], target: ['cpu'] },
    redraw,
    (algorithm) => series_colour(report, algorithm),
  );
  on_width(figure_element, draw);

  const key = h(
    'p',
    { class: 'key' },
    'Colour: algorithm. Thick: f32, thin: f64. Full line: cpu; dashes: cpu-fma; dots: cuda-nofma; dash and dot: cuda-fma. Band: 95 % interval. ',
    h('b', {}, '▲'),
    ' no error was seen from here on.',
  );
  return section(
    'margins',
    'Error rate against margin',
    h(
      'p',
      {},
      'How often a lane is wrong, against how close the call was. To the right pairs that are apart (errors are false positives), to the left pairs that intersect (errors are false negatives), by the exact distance or depth in ulps; in the middle pairs that touch.',
    ),
    h(
      'div',
      { class: 'controls' },
      choice(
        'Share',
        [
          ['log', 'logarithmic'],
          ['linear', 'linear'],
        ],
        log ? 'log' : 'linear',
        (value) => {
          log = value === 'log';
          choose('share', log ? '' : value);
          redraw();
        },
      ),
    ),
    picker.element,
    figure_element,
    key,
    h('h3', {}, 'From which margin on may a lane be trusted?'),
    h(
      'p',
      {},
      'That depends on the pairs: of those chosen, the smallest margin, a power of two, from which on no error was seen; how many pairs lie beyond it; and below which rate errors there are, with 95 % confidence for a threshold fixed before the campaign: the same data chose this one, so run another seed to confirm it.',
    ),
    h('div', { class: 'controls' }, trust),
    describes,
    thresholds.element,
    lazy_details(
      ['The chart’s numbers as a table'],
      () => {
        const table = sortable_table<Dot>(
          [
            { label: 'Lane', cell: (d) => report.lanes[d.lane].id, order: (d) => d.lane },
            { label: 'Margin', cell: (d) => d.words.split('\n')[1], order: (d) => d.x },
            { label: 'Wrong', cell: (d) => in_full(d.share), order: (d) => d.share.share, descending_first: true },
          ],
          { caption: 'Share wrong by margin, of the lanes chosen when this was opened', class: 'plain', page: 100 },
        );
        table.show(dots());
        return table.element;
      },
      { class: 'more-facts' },
    ).details,
  );
}
