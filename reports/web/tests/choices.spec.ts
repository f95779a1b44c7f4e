// SPDX-License-Identifier: Apache-2.0
import type { Choices } from '../src/report';
import { count } from '../src/format';
import { expect, pixels, test } from './page';
import type { Page } from '@playwright/test';

const choices = async (page: Page) =>
  JSON.parse((await page.locator('#choices').textContent())!) as {
    tuned: NonNullable<Choices['tuned']>;
    pareto: NonNullable<Choices['pareto']>;
  };

test('the front is the first picture: a dot for each lane, which leads to its row', async ({ page }) => {
  const { pareto } = await choices(page);
  expect(await page.locator('main figure').first().getAttribute('id')).toBe('front');
  await expect(page.locator('#front-chart svg g[data-mark="dot"] circle')).toHaveCount(pareto.lanes.length);
  await expect(page.locator('.pareto tbody tr')).toHaveCount(pareto.lanes.length);
  const dot = page.locator('#front-chart svg g[data-mark="dot"] circle').first();
  await dot.hover();
  await dot.click({ force: true });
  await expect(page).toHaveURL(/#pareto-/);
  const wrong = pareto.lanes.filter((lane) => lane.errors.false_negative + lane.errors.false_positive > 0);
  expect(wrong.length).toBeGreaterThan(3);
  for (const lane of wrong) expect(lane.failure).toMatch(/^(\S+ ){17}\S+$/);
  await expect(
    page.locator(`.pareto code[title="graze check '${wrong[0].failure}' --lanes '${wrong[0].lane}'"]`),
  ).toHaveCount(1);
});

test('the slider shows what each tolerance does and the lane under it', async ({ page }) => {
  const { tuned } = await choices(page);
  const readout = page.locator('#tuning output'),
    slider = page.locator('#tuning input[type=range]');
  await slider.scrollIntoViewIfNeeded();
  const first = await pixels(page.locator('#tuning-chart'));
  await expect(readout).toContainText('This is the chosen tolerance');
  const curve = tuned.curves.find((one) => one.points.some((point) => point.policy === tuned.chosen))!;
  await slider.fill(String(curve.points.length - 1));
  const last = curve.points.at(-1)!;
  await expect(readout).toContainText(`${last.policy}: ${count(last.false_negative)} false negatives`);
  await expect(readout).toContainText(`${count(last.false_positive)} false positives`);
  await expect(page.locator('#tuning pre')).toHaveText(`${tuned.lane}/${last.policy}`);
  expect(await pixels(page.locator('#tuning-chart'))).not.toBe(first);
  await page.locator('#tuning select').selectOption({ label: 'absolute, at all sites' });
  await slider.focus();
  await page.keyboard.press('End');
  await expect(readout).toContainText('abs:');
});

test('the pictures fit on a phone', async ({ page }) => {
  await page.setViewportSize({ width: 360, height: 740 });
  await page.locator('#tuning-chart').scrollIntoViewIfNeeded();
  await page.waitForTimeout(200);
  expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(360);
});
