// SPDX-License-Identifier: Apache-2.0
// report.json matches src/report.ts: TypeScript's compiler checks real reports as literals of type Report.
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { expect, test, type TestInfo } from '@playwright/test';
import type { Costs, Report } from '../src/report';

const here = dirname(fileURLToPath(import.meta.url));

// The part of a file that the page receives: everything except the checksum.
function parsed(file: string) {
  const value = JSON.parse(readFileSync(file, 'utf8'));
  expect(value.checksum).toMatch(/^[0-9a-f]{16}$/);
  delete value.checksum;
  return value;
}

const read = (page: string) => parsed(page.replace(/html$/, 'json')) as Report;

// The compiler's errors for each value against its type. One run checks all values, because each run takes seconds.
function complaints(values: Record<string, [type: string, value: unknown]>, info: TestInfo): Record<string, string> {
  const rows = Object.entries(values).map(
    ([name, [type, value]]) => `export const ${name}: ${type} = ${JSON.stringify(value)};\n`,
  );
  const file = info.outputPath('reports.ts');
  writeFileSync(
    file,
    `import type { Choices, Costs, Report } from ${JSON.stringify(resolve(here, '../src/report'))};\n${rows.join('')}`,
  );
  let said = '';
  try {
    execFileSync(
      process.execPath,
      [
        join(here, '../node_modules/typescript/bin/tsc'),
        '--noEmit',
        '--strict',
        '--pretty',
        'false',
        '--skipLibCheck',
        '--moduleResolution',
        'bundler',
        '--module',
        'ESNext',
        file,
      ],
      { encoding: 'utf8', cwd: info.outputDir },
    );
  } catch (error) {
    said = (error as { stdout: string }).stdout;
  }
  const of_line = (number: number) =>
    said
      .split(/^(?=\S)/m)
      .filter((one) => one.startsWith(`reports.ts(${number},`))
      .join('');
  const found = Object.fromEntries(Object.keys(values).map((name, i) => [name, of_line(i + 2)]));
  expect(Object.values(found).join('').length, said).toBe(said.length); // no message is about another line
  return found;
}

const beside = (name: string) => parsed(process.env.GRAZE_REPORT!.replace(/report.html$/, name));

test('real reports, costs and choices match report.ts', ({}, info) => {
  const { GRAZE_REPORT, GRAZE_COMPARE } = process.env;
  const campaign = read(GRAZE_REPORT!),
    compared = GRAZE_COMPARE ? read(GRAZE_COMPARE) : null,
    costs = beside('costs.json') as Costs;
  const [tuned, pareto] = [beside('tune.json'), beside('pareto.json')];
  expect(campaign.cards.some((card) => card.maps && card.snippets.length && card.sentences.length)).toBe(true);
  if (compared) expect(compared.compare).not.toBeNull();
  expect(costs.rows.length).toBeGreaterThan(20);
  expect(tuned.curves.length).toBeGreaterThan(3);
  expect(pareto.lanes.length).toBeGreaterThan(10);
  const found = complaints(
    {
      campaign: ['Report', campaign],
      ...(compared ? { compared: ['Report', compared] } : {}),
      costs: ['Costs', costs],
      choices: ['Choices', { tuned, pareto, discrepancy: { sentences: ['one'], page: 'discrepancy.html' } }],
      none: ['Choices', { tuned: null, pareto: null, discrepancy: null }],
    },
    info,
  );
  for (const [name, said] of Object.entries(found)) expect(said, name).toBe('');
});

test('values of other types are rejected', ({}, info) => {
  const whole = read(process.env.GRAZE_REPORT!),
    costs = beside('costs.json'),
    [tuned, pareto] = [beside('tune.json'), beside('pareto.json')];
  const right: Report = {
    ...whole,
    rates: [],
    margins: [],
    thresholds: [],
    extremes: [],
    side_by_side: [],
    signatures: [],
    sources: {},
    cards: [{ ...whole.cards[0], maps: null, snippets: [] }],
  };
  const { strata: _, ...missing } = right;
  const found = complaints(
    {
      right: ['Report', right],
      missing: ['Report', missing],
      more: ['Report', { ...right, lane: 1 }],
      kind: ['Report', { ...right, cards: [{ ...right.cards[0], kind: { ...right.cards[0].kind, shape: 'round' } }] }],
      deeper: ['Report', { ...right, cards: [{ ...right.cards[0], truth: { ...right.cards[0].truth, ulps: 0 } }] }],
      other_type: ['Report', { ...right, run: { ...right.run, seed: '1' } }],
      other_word: ['Report', { ...right, lanes: [{ ...right.lanes[0], scalar: 'f16' }] }],
      costs: ['Costs', { ...costs, passes: '9' }],
      choices: ['Choices', { tuned, pareto: { ...pareto, machine: 1 }, discrepancy: null }],
    },
    info,
  );
  const expected: Record<string, string> = {
    missing: "Property 'strata' is missing",
    more: `'"lane"' does not exist`,
    kind: `'"round"' is not assignable`,
    deeper: `'"ulps"' does not exist`,
    other_type: "'string' is not assignable to type 'number'",
    other_word: `'"f16"' is not assignable`,
    costs: "'string' is not assignable",
    choices: "'number' is not assignable",
  };
  expect(found.right).toBe('');
  for (const [name, part] of Object.entries(expected)) expect(found[name], name).toContain(part);
});
