// SPDX-License-Identifier: Apache-2.0
// A share of pairs against the exact margin, with a curve for each lane.
import * as Plot from '@observablehq/plot';
import { frame, named, series_colour, series_dash, series_width, shares_axis, x_label } from './chart';
import { h } from './dom';
import { count, in_full, percent, percent_bound, power_of_two } from './format';
import type { Report, Share } from './report';

type Point = Report['margins'][number]['points'][number];
export interface Dot {
  lane: number;
  x: number;
  share: Share;
  side: string;
  words: string;
}

const kNearest = -33; // one below the lowest exponent of a bucket
const kGap = 3; // units between the zero column and the nearest bucket, on both sides

const kOutermost = [-32, 31]; // the first and the last bucket, which are open-ended

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

// Draws a chart into `element`. what: the share to draw; title and label: its names; word: the adjective for the
// counted verdicts, such as "wrong".
export function margin_chart(
  report: Report,
  element: HTMLElement,
  what: 'wrong' | 'differs',
  { title, label, word }: { title: string; label: string; word: string },
  lanes_shown: () => number[],
  log: () => boolean,
) {
  const exponents = report.margins.flatMap((row) =>
    row.points.flatMap((p) => (p.exponent === null || !p.wrong.of ? [] : [p.exponent])),
  );
  const some = exponents.length > 0 ? exponents : [0]; // [0] if all pairs touch
  const lowest = Math.max(kNearest + 1, Math.min(...some)),
    highest = Math.max(...some);
  // Disjoint pairs are to the right of zero, and intersecting pairs to the left.
  const place = (side: string, exponent: number | null) =>
    exponent === null || side === 'zero' ? 0 : (side === 'disjoint' ? 1 : -1) * (exponent - lowest + kGap);
  const reach = highest - lowest + kGap + 1;
  const axis = shares_axis(report.margins.flatMap((row) => row.points.map((p) => p[what]?.share ?? 0)));

  function dots(): Dot[] {
    return lanes_shown()
      .flatMap((lane) => {
        const row = report.margins.find((r) => r.lane === lane);
        return (row?.points ?? []).flatMap((p) => {
          const share = p[what];
          if (!share?.of) return [];
          const x = place(p.side, p.exponent) + (p.side === 'disjoint' ? 0.5 : p.side === 'intersects' ? -0.5 : 0);
          return [
            { lane, x, side: p.side, share, words: `${report.lanes[lane].id}\n${side_words(p)}\n${in_full(share)}` },
          ];
        });
      })
      .sort((a, b) => a.x - b.x);
  }

  const pooled = (lane: number) =>
    report.thresholds.find((t) => t.lane === lane && t.group === null && t.stratum === null);
  const y = (share: number) => (log() ? axis.place(share) : 100 * share);

  function draw(width: number) {
    const all = dots(),
      small = width < 560;
    const ticks = [0];
    for (let e = Math.ceil((lowest + (small ? 8 : 0)) / 16) * 16; e <= highest; e += small ? 16 : 8)
      ticks.push(place('disjoint', e), place('intersects', e));
    const exponent_at = (x: number) => Math.abs(x) + lowest - kGap;
    const lanes = [...new Set(all.map((dot) => dot.lane))];
    const marks: Plot.Markish[] = [
      Plot.ruleX([0], { stroke: 'currentColor', strokeOpacity: 0.12, strokeWidth: small ? 8 : 14 }),
      Plot.ruleY([y(0)], { stroke: 'currentColor', strokeOpacity: 0.5 }),
    ];
    for (const lane of lanes) {
      const { algorithm, scalar, target } = report.lanes[lane];
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
            y: (d: Dot) => (log() && !d.share.count ? NaN : y(d.share.share)),
            stroke,
            strokeWidth,
            strokeDasharray: dash,
            strokeLinejoin: 'round',
          }),
          Plot.dot(log() ? own.filter((d) => !d.share.count) : [], { x: 'x', y: axis.none, r: 1.6, fill: stroke }),
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
      const own = what === 'wrong' ? pooled(lane) : undefined;
      const seen = (['disjoint', 'intersects'] as const).flatMap((side) => {
        const t = own?.[side];
        return t && t.exponent !== null && t.above
          ? [
              {
                x: place(side, t.exponent),
                words: `${report.lanes[lane].id}\nno error in ${count(t.above)} pairs from ${power_of_two(t.exponent)} ulps upwards\nrate below ${percent_bound(t.bound, 'upper')} (95 %)`,
              },
            ]
          : [];
      });
      marks.push(
        Plot.dot(seen, {
          x: 'x',
          y: y(0),
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
      ...frame(width, small ? 320 : 420, [26, 12, 50, 58]),
      x: {
        domain: [-reach, reach],
        ticks,
        tickFormat: (x: number) => (x === 0 ? '0' : power_of_two(exponent_at(x))),
        ...x_label(
          small
            ? 'margin, ulps: ← deep · apart →'
            : 'exact margin in ulps of the largest coordinate:  ← deeper inside  ·  farther apart →',
          42,
        ),
      },
      y: {
        ...(log() ? axis.options : { domain: [0, 100], tickFormat: (v: number) => `${v} %` }),
        grid: true,
        label,
        labelArrow: 'none',
      },
      marks,
    });
    const described = `${title}. ${lanes.map(lane_words).join('. ')}`;
    element.replaceChildren(
      all.length
        ? named(plot, described)
        : h('p', { class: 'empty' }, 'No lane is chosen, or the chosen lanes have no data here.'),
    );
  }

  // Describes a lane's curve in words: its share at margin 0, its worst margin, and the margins from which it is right.
  function lane_words(lane: number) {
    const points = (report.margins.find((row) => row.lane === lane)?.points ?? []).flatMap((point) => {
      const share = point[what];
      return share?.of ? [{ point, share }] : [];
    });
    const zero = points.find(({ point }) => point.side === 'zero'),
      own = what === 'wrong' ? pooled(lane) : undefined;
    const worst = points
      .filter(({ point }) => point.side !== 'zero')
      .reduce<(typeof points)[number] | null>((most, p) => (p.share.share > (most?.share.share ?? 0) ? p : most), null);
    const right = (['disjoint', 'intersects'] as const).map((side) =>
      own && own[side].exponent !== null
        ? `no error from ${power_of_two(own[side].exponent)} ulps ${side === 'disjoint' ? 'apart' : 'deep'}`
        : '',
    );
    return `${report.lanes[lane].id}: ${[
      zero && `${word} on ${percent(zero.share.share)} at margin 0`,
      worst ? `elsewhere at most ${percent(worst.share.share)}, ${side_words(worst.point)}` : `elsewhere none ${word}`,
      ...right,
    ]
      .filter(Boolean)
      .join('; ')}`;
  }

  return { dots, draw };
}
