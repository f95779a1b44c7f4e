// SPDX-License-Identifier: Apache-2.0
// Puts the page together from the report that `graze report` wrote into it.
import './style.css';
import { compare_section } from './compare';
import { h } from './dom';
import { extremes_section } from './extremes';
import { heat_styles } from './heat';
import { league_section } from './league';
import { margins_section } from './margins';
import { method_section } from './method';
import type { Report } from './report';
import { answer_section, run_section } from './run';
import { side_by_side_section } from './side_by_side';
import { signatures_section } from './signatures';

function build(report: Report) {
  document.head.append(heat_styles());
  const sections = [
    run_section(report), answer_section(report), compare_section(report), league_section(report), side_by_side_section(report),
    margins_section(report), extremes_section(report), signatures_section(report), method_section(),
  ].filter((one) => one !== null);
  const contents = sections.map((one) => h('a', { href: `#${one.id}` }, one.querySelector('h2')!.textContent));
  document.getElementById('page')!.replaceChildren(
    h('a', { class: 'skip', href: '#answer' }, 'To the answer'),
    h('header', {}, h('h1', {}, 'Graze: discrepancy report'), h('p', {}, 'Where triangle-triangle intersection tests stop being right, and how often')),
    h('nav', { 'aria-label': 'Contents' }, contents), h('main', {}, sections));
}

function start() {
  const page = document.getElementById('page')!;
  const text = document.getElementById('report')!.textContent!.trim();
  if (!text || text.startsWith('<!--')) page.textContent = 'This is the empty page: graze report DIR writes one with data.';
  else {
    const report = JSON.parse(text) as Report;
    if (report.format === 1) build(report);
    else page.textContent = `This page reads reports of format 1, and its data is of format ${report.format}.`;
  }
}

start();
