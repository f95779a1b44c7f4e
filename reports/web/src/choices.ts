// SPDX-License-Identifier: Apache-2.0
// Sections for the results of `graze tune`, `graze pareto` and `graze discrepancy` in the campaign's folder, if any.
import * as Plot from '@observablehq/plot';
import { frame, named, shares_axis, x_label } from './chart';
import { breakable, button, choice, code_block, copy_button, h, list, on_width, section, sentence } from './dom';
import { count, noisy_mark, percent, percent_bound, power_of_two, spread_words } from './format';
import type { Discrepancy, Errors, PolicyErrors, Report, Pareto, Tuned } from './report';
import { counts, table_of } from './sortable_table';
import { cell_text } from './pairs_of_cell';
import { go_to } from './state';

type Offer = Pareto['lanes'][number];

const failed = (e: Errors) => (e.crashed ?? 0) + (e.timed_out ?? 0) + (e.unstable ?? 0);
const without_answer = (e: Errors) =>
  e.false_negative + e.false_positive + failed(e) + e.declined + (e.by_convention ?? 0);
const share = (e: Errors) => (e.pairs ? without_answer(e) / e.pairs : 0);
const cost = (offer: Offer) => (offer.resident ?? offer.in_cache)!;
const far = (offer: Offer) => (offer.with_copies ?? offer.from_memory)!;
const nanoseconds = (ns: number) => ns.toFixed(ns < 1 ? 4 : 1);
const row_id = (lane: string) => `pareto-${lane.replace(/[^a-z0-9]+/gi, '-')}`;

// The chart beside the answer: each lane's cost against its share of pairs without a correct verdict. A click on a dot
// scrolls to the lane's row.
export function front(pareto: Pareto) {
  const axis = shares_axis(pareto.lanes.map((offer) => share(offer.errors)));
  const words = (offer: Offer) =>
    `${offer.lane}\n${nanoseconds(cost(offer).middle)} ns a pair\n${percent(share(offer.errors))} without a correct verdict${offer.dominated ? '\nanother lane costs no more and errs no more' : ''}`;
  const kept = pareto.lanes.filter((offer) => !offer.dominated).sort((a, b) => cost(a).middle - cost(b).middle);
  const element = h('div', { class: 'chart', id: 'front-chart' });
  const at = { x: (o: Offer) => cost(o).middle, y: (o: Offer) => axis.place(share(o.errors)) };
  on_width(element, (width) => {
    const small = width < 520;
    const plot = Plot.plot({
      ...frame(width, 330, [22, 14, 40, 54]),
      x: {
        type: 'log',
        inset: 12,
        ...x_label('nanoseconds a pair', 36),
        ticks: small ? 4 : 8,
        tickFormat: (v: number) => String(v),
      },
      y: { ...axis.options, grid: true, label: null },
      marks: [
        Plot.line(kept, { ...at, stroke: 'currentColor', strokeOpacity: 0.35 }),
        Plot.dot(pareto.lanes, {
          ...at,
          r: (o: Offer) => (o.dominated ? 3 : 5.5),
          fill: (o: Offer) => (o.dominated ? '#999' : 'var(--series-0)'),
        }),
        ...(small
          ? []
          : [0, 1].map((odd) =>
              Plot.text(
                kept.filter((_, i) => i % 2 === odd),
                { ...at, text: 'lane', dy: odd ? 14 : -12, fontSize: 11 },
              ),
            )),
        Plot.tip(pareto.lanes, Plot.pointer({ ...at, title: words, maxRadius: 24 })),
      ],
      r: { type: 'identity' },
    });
    plot.addEventListener('click', () => {
      const pointed = (plot as unknown as { value: Offer | null }).value;
      if (pointed) go_to(row_id(pointed.lane));
    });
    element.replaceChildren(
      named(plot, `Lanes by cost and errors, on ${pareto.machine}. ${pareto.lanes.map(words).join('. ')}`),
    );
  });
  return h(
    'figure',
    { class: 'glance', id: 'front' },
    h('p', { class: 'glance-title' }, 'Share of pairs without a correct verdict, against the cost of a pair'),
    element,
    h(
      'figcaption',
      {},
      `Large dots: no other lane costs less and errs less. Costs: pairs ${pareto.lanes[0]?.resident ? 'on the device' : 'in cache, one core'}; ${pareto.machine}.`,
    ),
  );
}

export function pareto_section(report: Report, pareto: Pareto) {
  const on_device = pareto.lanes.some((offer) => offer.resident);
  const pairs_of = (offer: Offer) => {
    const lane = report.lanes.findIndex((one) => one.id === offer.lane);
    const shown =
      lane >= 0 && report.rates.some((rate) => rate.lane === lane && rate.stratum === null && rate.wrong.count > 0);
    return (
      shown &&
      button('its failures', () => go_to('kinds', { cell: cell_text(report, { lane, stratum: null, kind: 'wrong' }) }))
    );
  };
  const table = table_of<Offer>(
    [
      { label: 'Lane', cell: (o) => h('td', { id: row_id(o.lane) }, breakable(o.lane)), order: (o) => o.lane },
      {
        label: 'ns a pair',
        numeric: true,
        cell: (o) =>
          h('td', { class: 'number', title: spread_words(cost(o)) }, nanoseconds(cost(o).middle) + noisy_mark(cost(o))),
        order: (o) => cost(o).middle,
      },
      {
        label: on_device ? 'with copies' : 'from memory',
        numeric: true,
        cell: (o) => nanoseconds(far(o).middle),
        order: (o) => far(o).middle,
      },
      counts('False negatives', (o) => o.errors.false_negative),
      counts('False positives', (o) => o.errors.false_positive),
      ...(pareto.lanes.some((o) => failed(o.errors))
        ? [counts('Crashed, timed out or unstable', (o: Offer) => failed(o.errors))]
        : []),
      counts('Declined', (o) => o.errors.declined),
      ...(pareto.lanes.some((o) => o.errors.by_convention)
        ? [counts('Allowed by its convention', (o: Offer) => o.errors.by_convention ?? 0)]
        : []),
      ...(on_device
        ? [
            counts('Registers', (o: Offer) => o.registers),
            counts('Local bytes', (o: Offer) => o.local_bytes),
            counts('Threads at once', (o: Offer) => o.active_threads),
          ]
        : []),
      {
        label: 'On the front',
        cell: (o) =>
          o.dominated ? '' : share(o.errors) === 0 ? `yes; under ${percent_bound(o.bound, 'upper')}` : 'yes',
        order: (o) => Number(o.dominated),
      },
      {
        label: 'Smallest failure',
        cell: (o) => {
          const command = `graze check '${o.failure}' --lanes '${o.lane}'`;
          return h(
            'td',
            { class: 'failure' },
            o.failure
              ? [
                  h('code', { title: command }, 'graze check …'),
                  ' ',
                  copy_button(command, `a small pair on which ${o.lane} is wrong`),
                ]
              : 'none seen',
            ' ',
            pairs_of(o),
          );
        },
        order: (o) => Number(!o.failure),
      },
    ],
    pareto.lanes,
    {
      caption: `Errors on ${count(pareto.lanes[0]?.errors.pairs ?? 0)} pairs, and costs on ${pareto.machine}`,
      class: 'plain pareto',
      page: 60,
    },
  );
  return section(
    'pareto',
    'Errors against cost',
    h(
      'p',
      {},
      'The table compares the errors of all lanes on the same pairs, and the cost of a pair. No other lane beats a lane on the front in both. For a lane without an error, the table shows the upper bound of its error rate at 95 % confidence.',
    ),
    table,
    list(pareto.sentences, { class: 'answer' }),
  );
}

const policy_of = (tuned: Tuned, point: PolicyErrors) =>
  tuned.epsilon
    ? `${tuned.epsilon.name} = ${point.policy.slice(point.policy.lastIndexOf(':') + 1)}`
    : point.policy
      ? `${tuned.lane}/${point.policy}`
      : tuned.lane;

export function tuned_section(tuned: Tuned) {
  const title = (curve: Tuned['curves'][number]) =>
    `${curve.tolerance === 'rel' ? 'relative' : 'absolute'}, ${curve.site === 'all' ? 'at all sites' : `at ${curve.site}`}`;
  const tolerance = (point: PolicyErrors) => Number(point.policy.slice(point.policy.lastIndexOf(':') + 1));
  let shown = Math.max(
    0,
    tuned.curves.findIndex((curve) => curve.points.some((point) => point.policy === tuned.chosen)),
  );
  let at = 0;
  const element = h('figure', { class: 'chart', id: 'tuning-chart' });
  const readout = h('output', { class: 'readout', 'aria-live': 'polite' });
  const policy = h('div', {});
  const slider = h('input', {
    type: 'range',
    min: 0,
    value: 0,
    step: 1,
    'aria-label': 'Tolerance',
    oninput: () => {
      at = Number(slider.value);
      tell();
      redraw();
    },
  });
  const curve = () => {
    const all = tuned.curves[shown];
    return { ...all, points: all.points.filter((point) => tolerance(point) > 0) }; // a logarithmic axis cannot show 0
  };

  function tell() {
    const point = curve().points[at];
    const part = (n: number, what: string) => `${count(n)} ${what} (${percent(n / point.pairs)})`;
    readout.textContent = `${point.policy}: ${part(point.false_negative, 'false negatives')}, ${part(point.false_positive, 'false positives')} of ${count(point.pairs)} pairs; fixes ${count(point.fixed)} and breaks ${count(point.broken)}${point.policy === tuned.chosen ? '. This is the chosen tolerance' : ''}.`;
    slider.setAttribute('aria-valuetext', readout.textContent);
    policy.replaceChildren(
      code_block(policy_of(tuned, point), tuned.epsilon ? 'this value of the epsilon' : 'the lane under this policy'),
    );
  }

  function draw(width: number) {
    const points = curve().points,
      x = (point: PolicyErrors) => Math.log2(tolerance(point));
    const axis = shares_axis(points.flatMap((e) => [e.false_negative / e.pairs, e.false_positive / e.pairs]));
    const lines = (
      [
        ['false_negative', 'var(--series-1)'],
        ['false_positive', 'var(--series-0)'],
      ] as const
    ).map(([kind, stroke]) =>
      Plot.line(points, {
        x,
        y: (e: PolicyErrors) => axis.place(e[kind] / e.pairs),
        stroke,
        strokeWidth: 2,
        strokeDasharray: kind === 'false_negative' ? '6 3' : '',
      }),
    );
    const chosen = points.filter((point) => point.policy === tuned.chosen);
    const plot = Plot.plot({
      ...frame(width, width < 560 ? 280 : 340, [14, 12, 44, 54]),
      x: {
        ...x_label(
          curve().tolerance === 'rel'
            ? 'K, in machine epsilons times the quantity’s size'
            : 'E, in the quantity’s own unit',
          38,
        ),
        ticks: width < 560 ? 5 : 10,
        tickFormat: (v: number) => power_of_two(v),
      },
      y: { ...axis.options, grid: true, label: null },
      marks: [
        ...lines,
        Plot.ruleX(chosen, { x, strokeDasharray: '4 3', strokeOpacity: 0.7 }),
        Plot.ruleX([points[at]], { x, stroke: 'currentColor', strokeWidth: 2 }),
      ],
    });
    element.replaceChildren(
      named(
        plot,
        `False negatives and false positives of ${tuned.lane} against its tolerance, ${title(curve())}. ${readout.textContent}`,
      ),
    );
  }
  const redraw = on_width(element, draw);

  function show(which: number) {
    shown = which;
    slider.max = String(curve().points.length - 1);
    at = Math.max(
      0,
      curve().points.findIndex((point) => point.policy === tuned.chosen),
    );
    slider.value = String(at);
    tell();
    redraw();
  }
  show(shown);
  return section(
    'tuning',
    `Which tolerance for ${tuned.lane}`,
    list(tuned.sentences, { class: 'answer' }),
    h(
      'div',
      { class: 'controls' },
      choice(
        'Curve',
        tuned.curves.map((one, i): [string, string] => [String(i), title(one)]),
        String(shown),
        (value) => show(Number(value)),
      ),
    ),
    element,
    h('label', { class: 'field slide' }, h('span', {}, 'Tolerance'), slider),
    h('p', {}, readout),
    policy,
    h(
      'p',
      { class: 'key' },
      h('span', { style: 'color:var(--series-1)' }, '╌╌'),
      ' false negatives, ',
      h('span', { style: 'color:var(--series-0)' }, '──'),
      ' false positives, on the pairs used to choose the tolerance. Dashed vertical line: the chosen tolerance.',
    ),
  );
}

export function discrepancy_section(found: Discrepancy) {
  return section(
    'discrepancy',
    'CPU against GPU',
    h(
      'ol',
      {},
      found.sentences.map((text) => h('li', {}, sentence(text))),
    ),
    h('p', {}, h('a', { href: found.page }, 'Every value, with pictures')),
  );
}
