// SPDX-License-Identifier: Apache-2.0
// Builds the page from the report that `graze report` wrote into it.
import './style.css';
import { kind_id } from './card';
import { follow_viewer } from './card_viewer';
import { discrepancy_section, pareto_section, tuned_section } from './choices';
import { compare_section } from './compare';
import { h, paragraph } from './dom';
import { count } from './format';
import { extremes_section } from './extremes';
import { failure_sections } from './failures';
import { heat_styles } from './heat';
import { league_section } from './league';
import { margins_section } from './margins';
import { method_section } from './method';
import type { Choices, Costs, Report } from './report';
import { answer_section, run_section } from './run';
import { side_by_side_section } from './side_by_side';
import { follow_fragment } from './state';
import { toolchains_section } from './toolchains';

function build(report: Report, costs: Costs | null, { tuned, pareto, discrepancy }: Choices) {
  document.head.append(heat_styles());
  const failures = failure_sections(report);
  const sections = [
    answer_section(report, costs, pareto),
    compare_section(report),
    tuned && tuned_section(tuned),
    pareto && pareto_section(report, pareto),
    league_section(report),
    ...failures.sections,
    margins_section(report),
    extremes_section(report, pareto),
    discrepancy && discrepancy_section(discrepancy),
    toolchains_section(report),
    side_by_side_section(report),
    method_section(),
    run_section(report, costs),
  ].filter((one) => one !== null);
  const contents = sections.map((one) => h('a', { href: `#${one.id}` }, one.querySelector('h2')!.textContent));
  const { pairs, seed } = report.run;
  document
    .getElementById('page')!
    .replaceChildren(
      h('a', { class: 'skip', href: '#answer' }, 'To the answer'),
      h(
        'header',
        {},
        h('h1', {}, 'Graze: discrepancy report'),
        paragraph(
          `Where triangle-triangle tests stop being right: ${count(pairs)} pairs of ${report.strata.length} ${report.strata.length === 1 ? 'stratum' : 'strata'}, ${report.lanes.length} lanes, seed ${seed}`,
        ),
      ),
      h('nav', { 'aria-label': 'Contents' }, contents),
      h('main', {}, sections),
    );
  follow_fragment((id) => {
    failures.open(id);
    document.getElementById(id)?.scrollIntoView({ block: 'start' });
  });
  follow_viewer(report, kind_id);
}

const data = (id: string) => document.getElementById(id)?.textContent?.trim() ?? '';

function start() {
  const page = document.getElementById('page')!;
  const text = data('report');
  if (!text || text.startsWith('<!--'))
    page.textContent = 'This page has no data. To make a report with data, run: graze report DIR';
  else {
    const report = JSON.parse(text) as Report;
    if (report.format === 2)
      build(report, JSON.parse(data('costs') || 'null') as Costs | null, JSON.parse(data('choices')) as Choices);
    else page.textContent = `This page reads reports in format 2, but its data is in format ${report.format}.`;
  }
}

start();
