// SPDX-License-Identifier: Apache-2.0
// The sections "What was run" and "The answer".
import { breakable, code_block, h, list, more_facts, section, sentence, type Child } from './dom';
import { count, nanoseconds, noisy_mark, percent, spread_words } from './format';
import { front } from './choices';
import { glance } from './glance';
import type { Costs, Report, Pareto } from './report';
import { counts, table_of } from './sortable_table';

// "20 lanes: twin, verified on …", one line for each kind of evidence.
function executors(report: Report): Child[] {
  const by_evidence = new Map<string, number>();
  for (const lane of report.lanes) {
    const words = lane.evidence ?? 'this build, on the CPU';
    by_evidence.set(words, (by_evidence.get(words) ?? 0) + 1);
  }
  return [...by_evidence].map(([words, lanes]) => h('div', {}, `${lanes} ${lanes === 1 ? 'lane' : 'lanes'}: ${words}`));
}

function strata_table(report: Report) {
  return table_of<Report['strata'][number]>(
    [
      { label: 'Stratum', cell: (s) => [s.id], order: (s) => report.strata.indexOf(s) },
      { label: 'What it draws', cell: (s) => [s.describes], order: (s) => s.describes },
      counts('Pairs', (s) => s.pairs),
      {
        label: 'Intersect',
        numeric: true,
        cell: (s) => (s.pairs ? percent(s.intersects / s.pairs) : '–'),
        order: (s) => s.intersects / s.pairs,
      },
    ],
    report.strata,
    { caption: 'Strata of the campaign', class: 'plain' },
  );
}

function lanes_table(report: Report) {
  return table_of<Report['lanes'][number]>(
    [
      { label: 'Lane', cell: (lane) => breakable(lane.id), order: (lane) => report.lanes.indexOf(lane) },
      { label: 'Reference', cell: (lane) => lane.paper, order: (lane) => lane.paper },
      {
        label: 'How it ran',
        cell: (lane) => lane.evidence ?? 'this build, on the CPU',
        order: (lane) => lane.evidence ?? '',
      },
    ],
    report.lanes,
    { caption: 'Lanes of the campaign', class: 'plain' },
  );
}

// A table with a row for each lane and a column for each group of strata.
function costs_table(report: Report, costs: Costs) {
  const lanes = [...new Set(costs.rows.map((row) => row.lane))];
  const of = (lane: number, group: number | null) => costs.rows.find((row) => row.lane === lane && row.group === group);
  const column = (label: string, group: number | null) => ({
    label,
    numeric: true,
    cell: (lane: number) => {
      const cost = of(lane, group);
      return cost
        ? h(
            'td',
            { class: 'number', title: `${spread_words(cost)}, over ${count(cost.pairs)} pairs` },
            nanoseconds(cost.middle) + noisy_mark(cost),
          )
        : '–';
    },
    order: (lane: number) => of(lane, group)?.middle ?? Infinity,
  });
  return table_of<number>(
    [
      { label: 'Lane', cell: (lane) => breakable(report.lanes[lane].id), order: (lane) => lane },
      column('all strata', null),
      ...report.groups.map(({ id }, group) => column(id, group)),
    ],
    lanes,
    {
      caption: `Cost of a pair on one core, many pairs a call: medians of ${costs.passes} passes`,
      class: 'plain costs',
    },
  );
}

export function build_words({ build }: Report['run']) {
  return [
    `graze ${build.version}, commit ${build.commit}`,
    build.compiler,
    build.cuda ?? 'built without CUDA',
    build.device ?? 'no CUDA device',
  ];
}

type Subject = NonNullable<Report['run']['subjects']>[number];

// "my.cpp, hash 0a…; by g++ …, flags -O3, CXX=…"
function subject_words({ what, hash, compiler, flags, environment }: Subject) {
  const set = Object.entries(environment ?? {}).map(([name, value]) => `${name}=${value}`);
  const built = [compiler && `by ${compiler}`, flags?.length && `flags ${flags.join(' ')}`, ...set].filter(Boolean);
  return `${what}, hash ${hash}${built.length ? `; ${built.join(', ')}` : ''}`;
}

export function run_section(report: Report, costs: Costs | null) {
  const { run } = report;
  const [graze, compiler, toolkit, device] = build_words(run);
  const facts: [string, Child][] = [
    ['Pairs', `${count(run.pairs)}${run.complete ? '' : ' so far: the campaign is not complete'}`],
    ['Seed', String(run.seed)],
    ['Scene', run.scene ?? null],
    ['Build', graze],
    ['Compiler', compiler],
    ['Toolkit', toolkit],
    ['Device', device],
    ['Machine', run.machine],
    ['Costs measured on', costs?.machine ?? 'not measured'],
    ['Executors', executors(report)],
    ...(run.subjects ?? []).map((subject): [string, Child] => [`Code of ${subject.name}`, subject_words(subject)]),
  ];
  return section(
    'run',
    'What was run',
    h(
      'dl',
      { class: 'facts' },
      facts
        .filter(([, value]) => value !== null)
        .map(([name, value]) => h('div', {}, h('dt', {}, name), h('dd', {}, value))),
    ),
    h('p', { class: 'label' }, 'Run the whole campaign again'),
    code_block(run.command, 'the campaign’s command'),
    h('p', { class: 'label' }, 'Make this page again from the stored results'),
    code_block(run.map_command, 'the report’s command'),
    more_facts(`${report.strata.length} strata`, () => strata_table(report)),
    more_facts(`${report.lanes.length} lanes`, () => lanes_table(report)),
    costs &&
      more_facts(`Costs of ${new Set(costs.rows.map((row) => row.lane)).size} lanes`, () => costs_table(report, costs)),
    report.missing.length > 0 &&
      h('div', { class: 'notice' }, h('strong', {}, 'What this report lacks'), list(report.missing.map(sentence))),
  );
}

// Emphasises the start: "Use exact/f32/cpu: …".
function advice(text: string): Child[] {
  const found = /^(Use|Avoid) [^:]*:/.exec(text);
  return found ? [h('b', {}, ...breakable(found[0])), text.slice(found[0].length)] : sentence(text);
}

const kFirst = 2,
  kBeside = 4; // on a phone, kFirst sentences are above the picture; on a wide page, kBeside sentences are beside it

export function answer_section(report: Report, costs: Costs | null, pareto: Pareto | null) {
  const said = (costs?.answer ?? report.answer).map((text) => h('li', {}, advice(text)));
  const list = (items: HTMLElement[], start: number) => items.length > 0 && h('ol', { class: 'answer', start }, items);
  return section(
    'answer',
    'The answer',
    !report.run.complete && h('p', { class: 'notice' }, 'The campaign is not finished: these are its figures so far.'),
    h(
      'div',
      { class: 'opening' },
      list(said.slice(0, kFirst), 1),
      h('div', { class: 'pictures' }, pareto && front(pareto), glance(report, costs)),
      list(said.slice(kFirst, kBeside), kFirst + 1),
    ),
    list(said.slice(kBeside), kBeside + 1),
  );
}
