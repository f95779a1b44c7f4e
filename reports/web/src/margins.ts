// SPDX-License-Identifier: Apache-2.0
// Error against margin: the share of wrong verdicts by the exact margin in ulps, and the threshold at or above which no
// error was seen.
import { series_colour } from './chart';
import { breakable, h, marked, more_facts, on_width, paragraph, section } from './dom';
import { in_full, percent_bound, power_of_two } from './format';
import { kept_choice } from './kept';
import { lane_picker, type Picker } from './lane_picker';
import { margin_chart, type Dot } from './margin_chart';
import type { Report, Threshold } from './report';
import { counts, sortable_table, table_of } from './sortable_table';
import { when_chosen } from './state';

type Row = Report['thresholds'][number];

// "2³", or the reason why there is no threshold.
const from_words = ({ exponent, largest }: Threshold) =>
  exponent !== null ? power_of_two(exponent) : largest === null ? 'no such pairs' : `wrong at ${power_of_two(largest)}`;

export function margins_section(report: Report) {
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
          counts('Pairs beyond', (t: Row) => t[side].above),
          {
            label: 'Rate below (95 %)',
            numeric: true,
            cell: (t: Row) => (t[side].above ? percent_bound(t[side].bound, 'upper') : '–'),
            order: (t: Row) => t[side].bound,
          },
        ];
      }),
    ],
    { caption: 'Thresholds of the chosen lanes', class: 'plain thresholds' },
  );

  // The strata of a threshold: a group of strata, one stratum, or all strata.
  const kinds: { id: string; label: string; is: (t: Row) => boolean }[] = [
    ...report.groups.map(({ id }, g) => ({ id, label: `group ${id}`, is: (t: Row) => t.group === g })),
    { id: 'all', label: 'all strata together', is: (t: Row) => t.group === null && t.stratum === null },
    ...report.strata.map(({ id }, s) => ({ id: `stratum ${id}`, label: id, is: (t: Row) => t.stratum === s })),
  ];
  const trust = kept_choice(
    'trust',
    'Pairs',
    kinds.map(({ id, label }): [string, string] => [id, label]),
    show_thresholds,
  );
  const describes = h('p', { class: 'key' });
  function show_thresholds() {
    const kind = kinds.find(({ id }) => id === trust.value())!,
      group = report.groups.find(({ id }) => id === kind.id);
    describes.textContent = group
      ? `${group.id}: ${group.describes} (${group.strata.map((s) => report.strata[s].id).join(', ')}).`
      : '';
    thresholds.show(report.thresholds.filter((t) => kind.is(t) && picker.lanes().includes(t.lane)));
  }
  when_chosen(show_thresholds);

  const chart = margin_chart(
    report,
    figure_element,
    'wrong',
    { title: 'Share of wrong verdicts against the exact margin, all strata', label: 'share wrong', word: 'wrong' },
    () => picker.lanes(),
    () => share.value() === 'log',
  );
  function draw(width: number) {
    chart.draw(width);
    show_thresholds();
  }

  const redraw = on_width(figure_element, draw);
  const share = kept_choice(
    'share',
    'Share',
    [
      ['log', 'logarithmic'],
      ['linear', 'linear'],
    ],
    redraw,
  );
  const published = [...new Set(report.lanes.filter((lane) => !lane.exact).map((lane) => lane.algorithm))];
  const picker: Picker = lane_picker(
    report,
    'margins',
    { algorithm: published, scalar: ['f32'], target: ['cpu'] },
    redraw,
    (algorithm) => series_colour(report, algorithm),
  );

  const key = h(
    'p',
    { class: 'key' },
    marked(
      'Colour: algorithm. Thick: f32, thin: f64. Full line: cpu; dashes: cpu-fma; dots: cuda-nofma; dash and dot: cuda-fma. Band: 95 % interval. **▲** no error was seen from here outwards.',
    ),
  );
  return section(
    'margins',
    'Error rate against margin',
    paragraph(
      'The chart shows how often a lane is wrong at each margin, which is the exact distance or depth in ulps. Pairs on the right are apart, so errors are false positives. Pairs on the left intersect, so errors are false negatives. Pairs in the middle touch.',
    ),
    h('div', { class: 'controls' }, share.element),
    picker.element,
    figure_element,
    key,
    h('h3', {}, 'From which margin upwards can a lane be trusted?'),
    paragraph(
      'The answer depends on the pairs. For the chosen pairs, the table shows the smallest margin (a power of two) at or above which no error was seen. It also shows the number of pairs beyond that margin, and a bound on the error rate there. The bound holds with 95 % confidence for a threshold that was fixed before the campaign. These thresholds come from the same data, so confirm them with another seed.',
    ),
    h('div', { class: 'controls' }, trust.element),
    describes,
    thresholds.element,
    more_facts('The chart’s numbers as a table', () =>
      table_of<Dot>(
        [
          { label: 'Lane', cell: (d) => report.lanes[d.lane].id, order: (d) => d.lane },
          { label: 'Margin', cell: (d) => d.words.split('\n')[1], order: (d) => d.x },
          { label: 'Wrong', cell: (d) => in_full(d.share), order: (d) => d.share.share, descending_first: true },
        ],
        chart.dots(),
        { caption: 'Share wrong by margin, for the lanes chosen when this was opened', class: 'plain', page: 100 },
      ),
    ),
  );
}
