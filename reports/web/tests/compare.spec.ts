// SPDX-License-Identifier: Apache-2.0
import { expect, test } from '@playwright/test';
import { readFileSync, writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { percent } from '../src/format';
import type { Report } from '../src/report';
import { compare_url } from './page';

test('toolchains: differences, wrong verdicts, and groups that agree', async ({ page }) => {
  test.skip(!process.env.GRAZE_COMPARE, 'GRAZE_REPORT names a single report');
  await page.goto(compare_url());
  const { toolchains } = JSON.parse((await page.locator('#report').textContent())!) as Report;
  const section = page.locator('#toolchains');
  await expect(section.locator('li')).toHaveText(toolchains!.sentences);
  const row = section.locator('tbody tr', { hasText: 'interval_overlap/f32' });
  const found = toolchains!.rows.find((one) => one.algorithm === 'interval_overlap')!;
  expect(toolchains!.variants).toEqual(expect.arrayContaining(['cpu', 'x86-gcc', 'x87']));
  for (const [value, shown] of [
    ['differs', 'differs'],
    ['wrong', 'wrong'],
  ] as const) {
    await section.locator('select').selectOption(value);
    for (const cell of found.cells) {
      const share = cell[shown]!;
      const in_cell = row.locator('th, td').nth(1 + cell.variant);
      await expect(in_cell).toHaveText(share.count ? percent(share.share) : '0');
    }
  }
  await page.setViewportSize({ width: 375, height: 740 });
  expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBe(375);
});

test('two campaigns compared: a headline, rates, kinds gained and lost', async ({ page }) => {
  test.skip(!process.env.GRAZE_COMPARE, 'GRAZE_REPORT names a single report');
  const said: string[] = [];
  page.on('console', (message) => said.push(message.text()));
  page.on('pageerror', (error) => said.push(error.message));
  await page.goto(compare_url());
  const { compare } = JSON.parse((await page.locator('#report').textContent())!) as Report;
  const section = page.locator('#compare');
  await page.setViewportSize({ width: 1280, height: 900 });
  expect(await page.locator('nav').evaluate((nav) => nav.scrollWidth - nav.clientWidth)).toBeLessThanOrEqual(0);
  await expect(section).toContainText(`seed ${compare!.other.seed}`);
  await expect(section.locator('.headline')).toHaveText(compare!.headline);
  expect(compare!.differences[0]).toContain('The seed differs');
  await expect(section.locator('.differences li')).toHaveText(compare!.differences);
  const tops = await section
    .locator('.headline, .differences, h3')
    .evaluateAll((all) => all.map((one) => one.className || one.localName));
  expect(tops.slice(0, 3)).toEqual(['headline', 'differences', 'h3']);
  const changed = compare!.rates.filter((rate) => rate.changed).length;
  const rows = section.locator('table').first().locator('tbody tr');
  await expect(rows).toHaveCount(Math.max(1, Math.min(60, changed))); // without changed rates, one row says so
  await section.locator('input[type=checkbox]').check();
  await expect(rows).toHaveCount(Math.min(60, compare!.rates.length));
  expect(compare!.kinds_compared).toBe(true);
  for (const [what, kinds] of [
    ['gained', compare!.gained],
    ['lost', compare!.lost],
  ] as const) {
    await expect(section).toContainText(
      `Kinds of failure ${what}: ${kinds.length ? kinds.length.toLocaleString('en-US') : 'none'}`,
    );
    for (const { key } of kinds.slice(0, 5)) await expect(section).toContainText(key);
  }
  // Campaigns of one build seldom gain or lose a kind, so the test writes one into the page.
  const file = test.info().outputPath('gained.html');
  const gained = { key: 'moller_1997/rounding/plane.h:1/general', signatures: 40, count: 1234 };
  const whole = readFileSync(fileURLToPath(compare_url()), 'utf8');
  const edited = whole.replace(/"gained":\s*\[\]/, `"gained":${JSON.stringify([gained])}`);
  expect(edited).not.toBe(whole);
  writeFileSync(file, edited);
  await page.goto(`file://${file}`);
  await expect(section).toContainText('Kinds of failure gained: 1');
  await expect(section).toContainText(gained.key);
  await expect(section).toContainText('1,234');
  await page.setViewportSize({ width: 375, height: 740 });
  expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBe(375);
  expect(said).toEqual([]);
});
