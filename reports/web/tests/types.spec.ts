// SPDX-License-Identifier: Apache-2.0
// report.json is what src/report.ts says: TypeScript's own compiler checks real reports, as literals of type Report.
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { expect, test, type TestInfo } from '@playwright/test';
import type { Costs, Report } from '../src/report';

const here = dirname(fileURLToPath(import.meta.url));

const read = (page: string) => JSON.parse(readFileSync(page.replace(/html$/, 'json'), 'utf8')) as Report;

// The compiler's complaints about values of type Report, or of another one.
function complaints(reports: Record<string, unknown>, info: TestInfo, type = 'Report'): string {
  const values = Object.entries(reports).map(([name, value]) => `export const ${name}: ${type} = ${JSON.stringify(value)};\n`);
  const file = info.outputPath('reports.ts');
  writeFileSync(file, `import type { ${type} } from ${JSON.stringify(resolve(here, '../src/report'))};\n${values.join('')}`);
  try {
    execFileSync(process.execPath, [join(here, '../node_modules/typescript/bin/tsc'), '--noEmit', '--strict', '--pretty', 'false', '--skipLibCheck',
      '--moduleResolution', 'bundler', '--module', 'ESNext', file], { encoding: 'utf8', cwd: info.outputDir });
    return '';
  } catch (error) {
    return (error as { stdout: string }).stdout;
  }
}

test('real reports are what report.ts says', ({}, info) => {
  const { GRAZE_REPORT, GRAZE_COMPARE } = process.env;
  const campaign = read(GRAZE_REPORT!), compared = GRAZE_COMPARE ? read(GRAZE_COMPARE) : null;
  expect(campaign.cards.some((card) => card.maps && card.snippets.length && card.sentences.length)).toBe(true);
  if (compared) expect(compared.compare).not.toBeNull();
  expect(complaints(compared ? { campaign, compared } : { campaign }, info)).toBe('');
});

test('real costs are what report.ts says', ({}, info) => {
  const costs = JSON.parse(readFileSync(process.env.GRAZE_REPORT!.replace(/report.html$/, 'costs.json'), 'utf8')) as Costs;
  expect(costs.rows.length).toBeGreaterThan(20);
  expect(complaints({ costs }, info, 'Costs')).toBe('');
  expect(complaints({ costs: { ...costs, passes: '9' } }, info, 'Costs')).toContain("'string' is not assignable");
});

test('real choices are what report.ts says', ({}, info) => {
  const [tuned, trade] = ['tune', 'trade'].map((name) => JSON.parse(readFileSync(process.env.GRAZE_REPORT!.replace(/report.html$/, `${name}.json`), 'utf8')));
  expect(tuned.curves.length).toBeGreaterThan(3);
  expect(trade.lanes.length).toBeGreaterThan(10);
  expect(complaints({ choices: { tuned, trade }, none: { tuned: null, trade: null } }, info, 'Choices')).toBe('');
  expect(complaints({ choices: { tuned, trade: { ...trade, machine: 1 } } }, info, 'Choices')).toContain("'number' is not assignable");
});

test('and others are told apart', ({}, info) => {
  const whole = read(process.env.GRAZE_REPORT!);
  const right: Report = { ...whole, rates: [], margins: [], thresholds: [], extremes: [], side_by_side: [], signatures: [], sources: {}, cards: [{ ...whole.cards[0], maps: null, snippets: [] }] };
  const { strata: _, ...missing } = right;
  const said = complaints({
    missing,
    more: { ...right, lane: 1 },
    kind: { ...right, cards: [{ ...right.cards[0], kind: { ...right.cards[0].kind, shape: 'round' } }] },
    deeper: { ...right, cards: [{ ...right.cards[0], truth: { ...right.cards[0].truth, ulps: 0 } }] },
    other_type: { ...right, run: { ...right.run, seed: '1' } },
    other_word: { ...right, lanes: [{ ...right.lanes[0], scalar: 'f16' }] },
  }, info);
  for (const part of ["Property 'strata' is missing", `'"lane"' does not exist`, `'"ulps"' does not exist`, "'string' is not assignable to type 'number'",
    `'"f16"' is not assignable`, `'"round"' is not assignable`]) expect(said).toContain(part);
});
