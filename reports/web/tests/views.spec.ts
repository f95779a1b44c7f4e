// SPDX-License-Identifier: Apache-2.0
// The page on a phone, in the dark, on paper, by keyboard, and for a screen reader.
import AxeBuilder from '@axe-core/playwright';
import type { Page } from '@playwright/test';
import { expect, open_card, test, url } from './page';

const brightness = (page: Page, property: 'color' | 'backgroundColor') =>
  page.evaluate((name) => getComputedStyle(document.body)[name].match(/[\d.]+/g)!.slice(0, 3).reduce((sum, c) => sum + Number(c) / 765, 0), property);

const violations = async (page: Page) =>
  (await new AxeBuilder({ page }).analyze()).violations.map((v) => `${v.id}: ${v.nodes.slice(0, 3).map((node) => node.target).join(', ')}`);

test('opens, and says how long it took', async ({ page }) => {
  await page.goto('about:blank');
  const started = Date.now();
  await page.goto(url());
  await page.waitForSelector('#method');
  console.log(`opened in ${Date.now() - started} ms`);
  await expect(page.locator('main > section')).not.toHaveCount(0);
  expect(await page.locator('h1').count()).toBe(1);
});

test('a phone shows it without scrolling sideways', async ({ page }) => {
  await page.setViewportSize({ width: 375, height: 740 });
  await page.locator('summary', { hasText: /lanes$/ }).click();
  const card = await open_card(page, 1);
  await card.locator('.snippets button').first().click();
  await page.waitForTimeout(300);
  expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBe(375);
  for (const id of ['#margin-chart svg', '#card-1 .board']) {
    const box = (await page.locator(id).first().boundingBox())!;
    expect(box.x).toBeGreaterThanOrEqual(0);
    expect(box.x + box.width).toBeLessThanOrEqual(375);
  }
});

test('dark where the reader wants it', async ({ page }) => {
  expect(await brightness(page, 'backgroundColor')).toBeGreaterThan(0.9);
  await page.emulateMedia({ colorScheme: 'dark' });
  expect(await brightness(page, 'backgroundColor')).toBeLessThan(0.15);
  expect(await brightness(page, 'color')).toBeGreaterThan(0.8);
});

test('paper shows the drawing and hides what cannot be pressed, dark or not', async ({ page }) => {
  await open_card(page, 1);
  await page.emulateMedia({ media: 'print', colorScheme: 'dark' });
  expect(await brightness(page, 'backgroundColor')).toBeGreaterThan(0.9);
  await expect(page.locator('nav')).toBeHidden();
  await expect(page.locator('#card-1 .copy').first()).toBeHidden();
  await expect(page.locator('#card-1 .paper svg')).toBeVisible();
  await expect(page.locator('#card-1 canvas')).toBeHidden();
  expect((await page.pdf({ preferCSSPageSize: true, printBackground: true })).length).toBeGreaterThan(50_000);
});

test('the keyboard reaches the answer first, and shows where it is', async ({ page }) => {
  await page.keyboard.press('Tab');
  await expect(page.locator('.skip')).toBeFocused();
  await page.keyboard.press('Tab');
  const outline = await page.evaluate(() => getComputedStyle(document.activeElement!).outlineStyle);
  expect(outline).toBe('solid');
});

for (const colorScheme of ['light', 'dark'] as const) {
  test(`axe finds nothing, ${colorScheme}`, async ({ page }) => {
    await page.emulateMedia({ colorScheme });
    await open_card(page, 1);
    expect(await violations(page)).toEqual([]);
  });
}
