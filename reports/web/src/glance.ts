// SPDX-License-Identifier: Apache-2.0
// The chart beside the answer: the errors of each lane by group of strata, and the lane's cost.
import * as Plot from '@observablehq/plot';
import { frame, named, shares_axis, x_label } from './chart';
import { h, on_width } from './dom';
import { count, in_full, is_noisy, nanoseconds, percent } from './format';
import type { Costs, Report } from './report';

interface Row {
  lane: number;
  name: string;
  wrong: number;
  cost: string;
}
interface Dot {
  name: string;
  group: string;
  x: number;
  words: string;
}

const kSymbols = ['circle', 'square', 'triangle', 'diamond2', 'star'] as const;

// The group of strata on which costs are compared, the same as in the answer's sentences. Null means all strata.
function cost_ground(report: Report) {
  const general = report.groups.findIndex((group) => group.id === 'general');
  return general < 0 ? null : general;
}

// Chooses one lane for each algorithm and precision, preferably the cpu lane. Lanes with fewer wrong verdicts come
// first.
function glance_rows(report: Report, costs: Costs | null): Row[] {
  const total = new Map(
    report.rates.filter((rate) => rate.stratum === null).map((rate) => [rate.lane, rate.wrong.count]),
  );
  const ground = cost_ground(report);
  const families = new Map<string, number>();
  report.lanes.forEach(({ algorithm, scalar, target }, lane) => {
    const family = `${algorithm}/${scalar}`;
    if (!families.has(family) || target === 'cpu') families.set(family, lane);
  });
  return [...families.values()]
    .map((lane) => {
      const cost = costs?.rows.find((row) => row.lane === lane && row.group === ground);
      return {
        lane,
        name: report.lanes[lane].id,
        wrong: total.get(lane) ?? 0,
        cost: cost ? (is_noisy(cost) ? '≈ ' : '') + nanoseconds(cost.middle) : '',
      };
    })
    .sort((a, b) => a.wrong - b.wrong || a.lane - b.lane);
}

export function glance(report: Report, costs: Costs | null) {
  const rows = glance_rows(report, costs);
  const wrong = new Map(report.group_rates.map(({ lane, group, wrong }) => [`${lane}/${group}`, wrong]));
  const share_of = (row: Row, group: number) => wrong.get(`${row.lane}/${group}`)!;
  const axis = shares_axis(rows.flatMap((row) => report.groups.map((_, g) => share_of(row, g).share)));
  const dots: Dot[] = rows.flatMap((row) =>
    report.groups.map(({ id }, g) => {
      const share = share_of(row, g);
      return {
        name: row.name,
        group: id,
        x: axis.place(share.share),
        words: `${row.name}\ngroup ${id}: ${in_full(share)}`,
      };
    }),
  );
  const of_type = report.groups.some(({ id }) => id === 'general/f64') ? ' of float32' : '';
  const pair = `${cost_ground(report) === null ? 'a pair' : `a general pair${of_type}`}, many pairs a call`;
  const title = `Wrong verdicts of each lane, by group of strata${rows.some((row) => row.cost) ? `, and its cost for ${pair}` : ''}`;
  const element = h('div', { class: 'chart' });
  const said = rows
    .map((row) => {
      const groups = report.groups.map(({ id }, g) => {
        const share = share_of(row, g);
        return `${share.count ? percent(share.share) : 'none'} of ${id}`;
      });
      return `${row.name}: wrong on ${groups.join(', ')}${row.cost && `; ${row.cost}`}`;
    })
    .join('. ');

  on_width(element, (width) => {
    const small = width < 520,
      pitch = small ? 36 : 27;
    const plot = Plot.plot({
      ...frame(width, rows.length * pitch + 62, [20, rows.some((row) => row.cost) ? 56 : 14, 42, small ? 8 : 186]),
      x: { ...axis.options, ...x_label('share of wrong verdicts', 38) },
      y: { domain: rows.map((row) => row.name), label: null, axis: small ? null : 'left', tickSize: 0 },
      symbol: { domain: report.groups.map((group) => group.id), range: [...kSymbols] },
      marks: [
        Plot.ruleY(rows, { y: 'name', stroke: 'currentColor', strokeOpacity: 0.15, dy: small ? 6 : 0 }),
        Plot.dot(dots, {
          x: 'x',
          y: 'name',
          dy: small ? 6 : 0,
          symbol: 'group',
          r: 4.5,
          fill: (d: Dot) => `var(--series-${report.groups.findIndex((g) => g.id === d.group)})`,
          fillOpacity: 0.85,
        }),
        ...(small
          ? [Plot.text(rows, { y: 'name', x: axis.none, text: 'name', textAnchor: 'start', dy: -8, fontSize: 11 })]
          : []),
        Plot.text(rows, {
          y: 'name',
          text: 'cost',
          frameAnchor: 'right',
          textAnchor: 'start',
          dx: 10,
          dy: small ? 6 : 0,
        }),
        Plot.tip(dots, Plot.pointer({ x: 'x', y: 'name', title: 'words', maxRadius: 24 })),
      ],
    });
    element.replaceChildren(named(plot, `${title}. ${said}`));
  });

  const timed = costs?.rows.find((row) => row.lane === rows[0]?.lane && row.group === cost_ground(report));
  return h(
    'figure',
    { class: 'glance', id: 'glance' },
    h('p', { class: 'glance-title' }, title),
    h(
      'p',
      { class: 'glance-key' },
      report.groups.map(({ id, describes }, g) =>
        h(
          'span',
          { title: describes },
          h('i', { style: `color:var(--series-${g})`, 'aria-hidden': 'true' }, ['●', '■', '▲', '◆', '★'][g]),
          ` ${id}`,
        ),
      ),
    ),
    element,
    h(
      'figcaption',
      {},
      costs
        ? `Cost: median of ${costs.passes} passes${timed ? ` over ${count(timed.pairs)} of the campaign’s pairs` : ''}, one core, ${costs.machine}.${rows.some((row) => !row.cost) ? ' Lanes without a cost were not timed: your own code, and CUDA lanes without a device.' : ''}`
        : 'This page has no lane costs.',
    ),
  );
}
