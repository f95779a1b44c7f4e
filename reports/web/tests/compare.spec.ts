// SPDX-License-Identifier: Apache-2.0
import { pathToFileURL } from 'node:url';
import { expect, test } from '@playwright/test';
import type { Report } from '../src/report';

test('two campaigns compared: rates that changed, signatures gained and lost', async ({ page }) => {
  test.skip(!process.env.GRAZE_COMPARE, 'GRAZE_REPORT names a single report');
  const said: string[] = [];
  page.on('console', (message) => said.push(message.text()));
  page.on('pageerror', (error) => said.push(error.message));
  await page.goto(pathToFileURL(process.env.GRAZE_COMPARE!).href);
  const { compare } = JSON.parse((await page.locator('#report').textContent())!) as Report;
  const section = page.locator('#compare');
  await expect(section).toContainText(`seed ${compare!.other.seed}`);
  const changed = compare!.rates.filter((rate) => rate.changed).length;
  const rows = section.locator('table').first().locator('tbody tr');
  await expect(rows).toHaveCount(Math.max(1, Math.min(60, changed)));  // one that says so, where there is none
  await section.locator('input[type=checkbox]').check();
  await expect(rows).toHaveCount(Math.min(60, compare!.rates.length));
  expect(compare!.gained.length + compare!.lost.length).toBeGreaterThan(0);
  await expect(section).toContainText(`Signatures gained: ${compare!.gained.length.toLocaleString('en-US')}`);
  await expect(section).toContainText(`Signatures lost: ${compare!.lost.length.toLocaleString('en-US')}`);
  await page.setViewportSize({ width: 375, height: 740 });
  expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBe(375);
  expect(said).toEqual([]);
});
