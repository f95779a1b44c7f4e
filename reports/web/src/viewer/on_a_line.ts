// SPDX-License-Identifier: Apache-2.0
// Draws the ranges that the chosen lane compared on a line: intervals or projections. Also draws the same ranges
// computed with 113 bits, and the ranges on the axis of the margin.
import { choice, h, on_width, paragraph, section, type Child } from '../dom';
import { figure } from '../format';
import { differing } from './apart';
import { chart, type Row } from './chart';
import type { Drawing } from './graze.js';
import type { Model } from './model';
import { ulp_of } from './numbers';
import { exact_gap, intervals, lane_gap, projections, telling, type Ends, type Ranges } from './ranges';

const kIntervals: Record<string, string> = {
  moller_1997:
    'Their ends are positions along the line’s largest axis, all multiplied by one factor, because the lane does not divide.',
  interval_overlap: 'Their ends are positions along that line, measured from a point on it that the lane computed.',
};

const words = (gap: number, end: Ends[]) =>
  gap > 0
    ? `are ${figure(gap)} apart`
    : gap < 0
      ? `overlap by ${figure(-gap)}`
      : end.flat().every(Number.isFinite)
        ? 'meet in one point'
        : 'are not numbers';

export function on_a_line(model: Model) {
  let axis = -1,
    subject = '',
    rows: Row[] = [],
    scalar = 'f32',
    drawing: Drawing;
  const picture = h('div', { class: 'chart' }),
    truth_picture = h('div', { class: 'chart' }),
    said = h('div', {}),
    truth_said = h('p', {}),
    choices = h('div', { class: 'controls' });
  let truth_row: Row[] = [];
  const draw = (into: HTMLElement, of: () => Row[]) =>
    on_width(into, (width) => into.replaceChildren(...(of().length ? [chart(of(), ulp_of(scalar), width)] : [])));
  const draw_again = [draw(picture, () => rows), draw(truth_picture, () => truth_row)];

  // beside: the ranges of the lane's counterpart on the GPU or CPU, if the two differ.
  function show(ranges: Ranges, how: Child, beside: [string, Ranges | null | undefined] | null) {
    const { a, b, exact_a, exact_b } = ranges,
      name = h('code', {}, model.lane);
    rows = [...a, ...b, ...exact_a, ...exact_b].every(Number.isFinite)
      ? [
          ...(beside?.[1] ? [{ name: `in ${beside[0]}`, a: beside[1].a, b: beside[1].b }] : []),
          { name: `in ${model.lane}`, a, b },
          { name: 'with 113 bits', a: exact_a, b: exact_b },
        ]
      : [];
    said.replaceChildren(
      paragraph(
        how,
        h(
          'span',
          { class: 'compared' },
          `In `,
          name,
          ` the two ranges ${words(lane_gap(ranges), [a, b])}; with 113 bits they ${words(exact_gap(ranges), [exact_a, exact_b])}.`,
        ),
      ),
    );
  }

  const beside = (lane: string) => {
    const gpu = differing(model, lane);
    return gpu && (gpu === lane ? model.counterpart(lane, 'cpu') : gpu);
  };

  // Shows the ranges that the lane compared on a line, unless it decided before comparing any.
  function of_the_lane() {
    const { lane, pair, graze } = model,
      run = graze.steps(pair, lane)?.steps ?? [],
      [name] = lane.split('/');
    const found = kIntervals[name] ? intervals(run) : null,
      axes = found ? [] : projections(run, name);
    const other = beside(lane),
      other_run = other ? (graze.steps(pair, other)?.steps ?? []) : [];
    choices.replaceChildren();
    rows = [];
    if (found)
      return show(
        found,
        ['Intervals on ', h('b', {}, 'L, the line where the planes meet'), `. ${kIntervals[name]} `],
        other ? [other, intervals(other_run)] : null,
      );
    if (!axes.length)
      return said.replaceChildren(
        paragraph(
          name === 'guigue_devillers_2003'
            ? 'This algorithm compares no ranges, only signs.'
            : kIntervals[name] || name === 'projected_sat' || name === 'separating_axes'
              ? `The lane decided before it computed ${kIntervals[name] ? 'intervals' : 'projections'}.`
              : 'The exact decision compares no ranges.',
        ),
      );
    const at = axis >= 0 && axis < axes.length ? axis : telling(axes);
    choices.replaceChildren(
      choice(
        'Axis',
        axes.map((one, i) => [
          String(i),
          `${i + 1} of ${axes.length}: ${one.name}${lane_gap(one) > 0 ? ', separates' : ''}`,
        ]),
        String(at),
        (value) => {
          axis = Number(value);
          update();
        },
      ),
    );
    const parts =
      lane_gap(axes[at]) > 0
        ? 'on which the lane finds the triangles apart'
        : exact_gap(axes[at]) > 0
          ? 'that separates them with 113 bits, but not in the lane'
          : axis >= 0
            ? ''
            : 'on which they overlap least';
    show(
      axes[at],
      ['Projections on an axis', parts && ` ${parts}`, ': ', h('b', {}, axes[at].name), '. '],
      other ? [other, projections(other_run, name)[at]] : null,
    );
  }

  function of_the_margin() {
    const { truth } = model.decided,
      [p] = drawing.witness,
      [a, b] = drawing.features;
    truth_row = [];
    if (truth.verdict === 'declined') return truth_said.replaceChildren();
    if (!p)
      return truth_said.replaceChildren(
        truth.verdict === 'disjoint'
          ? 'The gap is too small for 113 bits to draw a separating axis.'
          : 'The triangles touch or lie in one plane. No axis separates them, but an arbitrarily short push does.',
      );
    truth_row = [{ name: 'with 113 bits', a: drawing.along[0], b: drawing.along[1] }];
    const [, high] = drawing.along[0],
      [low] = drawing.along[1],
      normals = [a, b].filter((one) => one.startsWith('face'));
    truth_said.replaceChildren(
      ...(truth.verdict === 'disjoint'
        ? [
            h('b', {}, 'A separating axis'),
            ` goes through the nearest points, which are on ${a} and on ${b}. On it a ends ${figure(low - high)} before b begins; that is the margin.`,
          ]
        : [
            h('b', {}, 'The shortest push'),
            ` that separates them goes along ${normals.length ? `the normal of ${normals[0].slice(-1)}` : `the common normal of ${a} and ${b}`}, by ${figure(high - low)}; that is the margin.`,
          ]),
    );
  }

  function update() {
    if (subject !== model.lane) axis = -1;
    subject = model.lane;
    scalar = model.lane.split('/')[1];
    drawing = model.graze.drawing(model.pair);
    of_the_lane();
    of_the_margin();
    draw_again.forEach((again) => again());
  }
  return {
    update,
    element: section('ranges', 'On a line', said, choices, picture, truth_said, truth_picture),
  };
}
