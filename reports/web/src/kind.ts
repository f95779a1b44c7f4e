// SPDX-License-Identifier: Apache-2.0
// Describes a kind of failure: its title, its lanes, the origins of its pairs, their margins, and the worst pair.
import * as Plot from '@observablehq/plot';
import { frame, named, x_label } from './chart';
import { breakable, code_block, h, on_width, type Child } from './dom';
import { count, counted, figure, margin_order, margin_words } from './format';
import type { FailureKind, Report } from './report';

type Card = Report['cards'][number];

// File and line: "moller_1997.h:117".
const place_of = (line: string) => line.slice(line.lastIndexOf('/') + 1);

export const kind_words = ({ subject, cause, line, shape }: FailureKind) =>
  `${subject}: ${cause}${line && ` at ${place_of(line)}`}, ${shape} pairs`;

export const kind_title = ({ subject, cause, line, shape }: FailureKind): Child[] => [
  h('b', {}, subject),
  `: ${cause}`,
  line ? [' at ', h('code', {}, ...breakable(place_of(line)))] : '',
  `, ${shape} pairs`,
];

// Lane names without the algorithm: "f32/cpu, f64/cpu".
export const within = (ids: string[]) => ids.map((id) => id.split('/').slice(1).join('/')).join(', ');

// Names the kind's lanes and those that are wrong on the pair shown, and counts those whose cause is settled.
export function kind_lanes(report: Report, { kind, verdicts }: Card) {
  const wrong = new Set(verdicts.filter((verdict) => verdict.wrong).map((verdict) => report.lanes[verdict.lane].id));
  const here = kind.lanes.filter((id) => wrong.has(id)),
    [yes, of] = kind.settled;
  return h(
    'p',
    { class: 'kind-lanes' },
    'Lanes that fail in this way: ',
    h('span', { class: 'all' }, within(kind.lanes)),
    '. ',
    here.length < kind.lanes.length && [
      'Wrong on the pair shown here: ',
      h('span', { class: 'here' }, within(here)),
      '. ',
    ],
    yes < of && `The cause is settled for ${count(yes)} of ${count(of)} examined lanes.`,
  );
}

interface Bar {
  name: string;
  pairs: number;
  words: string;
}

function histogram(
  name: string,
  title: string,
  bars: Bar[],
  draw: (width: number, bars: Bar[]) => SVGSVGElement | HTMLElement,
) {
  const element = h('div', { class: 'chart' });
  const said = bars
    .filter((bar) => bar.pairs > 0)
    .map((bar) => bar.words)
    .join('; ');
  on_width(element, (width) => element.replaceChildren(named(draw(width, bars), `${title}: ${said}`)));
  return h('figure', { class: `histogram ${name}` }, h('figcaption', {}, title), element);
}

function strata_histogram({ strata }: FailureKind) {
  const bars = Object.entries(strata)
    .sort((l, r) => r[1] - l[1])
    .map(([name, pairs]) => ({ name, pairs, words: `${name} ${count(pairs)}` }));
  const sum = bars.reduce((all, bar) => all + bar.pairs, 0);
  return histogram('strata', `Strata of the ${counted(sum, 'pair')} kept of this kind`, bars, (width) =>
    Plot.plot({
      ...frame(width, 22 + 18 * bars.length, [2, 40, 4, 124]),
      x: { axis: null },
      y: { domain: bars.map((bar) => bar.name), label: null, tickSize: 0 },
      marks: [
        Plot.barX(bars, { x: 'pairs', y: 'name', fill: 'var(--accent)', insetTop: 2, insetBottom: 2, title: 'words' }),
        Plot.text(bars, { x: 'pairs', y: 'name', text: (bar: Bar) => count(bar.pairs), textAnchor: 'start', dx: 4 }),
      ],
    }),
  );
}

// All buckets between the deepest and the shallowest overlap, bucket 0, and all between the smallest and the largest
// distance.
function buckets_of(margins: FailureKind['margins']): string[] {
  const side = (sign: string) => {
    const exponents = Object.keys(margins)
      .filter((bucket) => bucket.startsWith(sign))
      .map((bucket) => Number(bucket.slice(3)));
    const least = Math.min(...exponents),
      most = Math.max(...exponents);
    return exponents.length ? Array.from({ length: most - least + 1 }, (_, i) => `${sign}2^${least + i}`) : [];
  };
  return [...side('-'), '0', ...side('+')].sort((l, r) => margin_order(l) - margin_order(r));
}

// The buckets whose names are shown below their columns: 0, both ends, and every fourth exponent where there is room.
function ticks_of(bars: Bar[], column: number): string[] {
  const named = (i: number) => Number(bars[i].name.slice(3)) % 4 === 0;
  const wanted = [bars.findIndex((bar) => bar.name === '0'), 0, bars.length - 1, ...bars.keys()].filter(
    (i, order) => order < 3 || named(i),
  );
  const chosen: number[] = [];
  for (const i of wanted) {
    if (chosen.every((other) => Math.abs(i - other) * column >= 36)) chosen.push(i);
  }
  return chosen.map((i) => bars[i].name);
}

function margins_histogram(kind: FailureKind) {
  const bars = buckets_of(kind.margins).map((name) => {
    const pairs = kind.margins[name] ?? 0;
    return { name, pairs, words: `${margin_words(name)}${name.startsWith('+') ? ' apart' : ''}: ${count(pairs)}` };
  });
  const sides = [bars[0].name !== '0' && '← deep', bars[bars.length - 1].name !== '0' && 'apart →']
    .filter(Boolean)
    .join('      ');
  return histogram('margins', `Margins of the ${counted(kind.pairs, 'pair')} of this kind, in ulps`, bars, (width) =>
    Plot.plot({
      ...frame(width, 128, [6, 16, 36, 12]),
      x: {
        type: 'band',
        padding: 0.12,
        domain: bars.map((bar) => bar.name),
        ticks: ticks_of(bars, (width - 28) / bars.length),
        tickFormat: (name: string) => margin_words(name).replace(/ ulps.*/, ''),
        tickSize: 3,
        ...x_label(sides || null, 32),
      },
      y: { axis: null },
      marks: [
        Plot.barY(bars, { x: 'name', y: 'pairs', fill: 'var(--accent)', title: 'words' }),
        Plot.ruleY([0], { strokeOpacity: 0.3 }),
      ],
    }),
  );
}

function worst({ kind, pair, commands }: Card) {
  const { margin_ulps, from } = kind.worst;
  const margin =
    margin_ulps === 0 ? 'margin 0' : `${figure(Math.abs(margin_ulps))} ulps ${margin_ulps < 0 ? 'deep' : 'apart'}`;
  if (kind.worst.pair === pair.hex.join(' '))
    return h('p', { class: 'worst' }, `The pair shown is also the worst examined pair: ${margin}.`);
  // Reuses the card's own command, because that command says where foreign code is.
  const explain = commands
    .find(({ label }) => label === 'explain')!
    .text.replace(/^.*graze explain case.pairs/, 'graze explain worst.pairs');
  const command = `echo '${kind.worst.pair}' > worst.pairs; ${explain}`;
  return h(
    'div',
    { class: 'worst' },
    h('p', {}, `The worst examined pair of the kind: ${margin}, from `, h('code', {}, from), '.'),
    code_block(command, 'the command that explains the worst pair'),
  );
}

export function kind_facts(card: Card) {
  return h(
    'div',
    { class: 'kind-facts' },
    h('h4', {}, 'The kind'),
    h(
      'div',
      { class: 'histograms' },
      Object.keys(card.kind.strata).length > 0 && strata_histogram(card.kind),
      margins_histogram(card.kind),
    ),
    worst(card),
  );
}
