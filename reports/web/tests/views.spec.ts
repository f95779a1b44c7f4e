// SPDX-License-Identifier: Apache-2.0
// The page on a phone, in dark mode, on paper, by keyboard, and with a screen reader.
import type { Page } from '@playwright/test';
import { nanoseconds, percent } from '../src/format';
import { compare_url, expect, open_card, test, url, violations } from './page';

const kPhone = { width: 390, height: 844 };

const brightness = (page: Page, property: 'color' | 'backgroundColor') =>
  page.evaluate(
    (name) =>
      getComputedStyle(document.body)
        [name].match(/[\d.]+/g)!
        .slice(0, 3)
        .reduce((sum, c) => sum + Number(c) / 765, 0),
    property,
  );

test('the page opens, and the test prints the time', async ({ page }) => {
  await page.goto('about:blank');
  const started = Date.now();
  await page.goto(url());
  await page.waitForSelector('#method');
  console.log(`opened in ${Date.now() - started} ms`);
  await expect(page.locator('main > section')).not.toHaveCount(0);
  expect(await page.locator('h1').count()).toBe(1);
});

for (const viewport of [{ width: 1280, height: 800 }, kPhone]) {
  test(`opens with the answer and its picture, ${viewport.width} wide`, async ({ page, report, costs }) => {
    await page.setViewportSize(viewport);
    const said = page.locator('#answer li');
    await expect(said).toHaveText(costs?.answer ?? report.answer);
    await expect(said.nth(0)).toContainText(/^Use exact.* ns .*a general pair/);
    await expect(said.nth(0)).toBeInViewport({ ratio: 1 });
    await expect(said.nth(1)).toBeInViewport({ ratio: 1 });
    await expect(page.locator('#answer figure svg').first()).toBeInViewport();
    await expect(page.locator('main > section').last()).toHaveAttribute('id', 'run');
    expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBe(viewport.width);
  });
}

test('the picture beside the answer has a label with its numbers', async ({ page, report, costs }) => {
  const label = (await page.locator('#glance svg').first().getAttribute('aria-label'))!;
  const lane = report.lanes.findIndex((one) => one.id === 'moller_1997/f32/cpu');
  const wrong = report.group_rates.find(
    (rate) => rate.lane === lane && report.groups[rate.group].id === 'general',
  )!.wrong;
  expect(label).toContain(`moller_1997/f32/cpu: wrong on ${percent(wrong.share)} of general`);
  expect(label).toContain('exact/f32/cpu: wrong on none of general');
  const cost = costs!.rows.find((row) => row.lane === lane && report.groups[row.group ?? -1]?.id === 'general')!;
  expect(label).toContain(nanoseconds(cost.middle));
  await expect(page.locator('#glance svg').first()).toContainText(nanoseconds(cost.middle));
});

test('every picture has its own label', async ({ page, report }) => {
  const place = report.cards.findIndex((card) => card.maps);
  await open_card(page, place + 1);
  for (const [i, image] of (await page.locator(`#kind-${place + 1} .panel img`).all()).entries()) {
    const { name, shows } = report.cards[place].maps!.panels[i];
    expect(await image.getAttribute('alt')).toBe(`${name}: ${shows}`);
    expect(shows).toMatch(/\d|right everywhere/);
  }
  await expect(page.locator(`#kind-${place + 1} .board`)).toHaveAttribute(
    'aria-label',
    new RegExp(report.cards[place].truth.verdict),
  );
});

test('the page fits on a phone without sideways scrolling', async ({ page }) => {
  await page.setViewportSize({ width: 375, height: 740 });
  await page.locator('summary', { hasText: /lanes$/, hasNotText: /^Costs/ }).click();
  const card = await open_card(page, 1);
  await card.locator('.snippets button').first().click();
  await page.waitForTimeout(300);
  expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBe(375);
  for (const id of ['#margin-chart svg', '#kind-1 .board']) {
    const box = (await page.locator(id).first().boundingBox())!;
    expect(box.x).toBeGreaterThanOrEqual(0);
    expect(box.x + box.width).toBeLessThanOrEqual(375);
  }
});

test('the page is dark if the reader prefers that', async ({ page }) => {
  expect(await brightness(page, 'backgroundColor')).toBeGreaterThan(0.9);
  await page.emulateMedia({ colorScheme: 'dark' });
  expect(await brightness(page, 'backgroundColor')).toBeLessThan(0.15);
  expect(await brightness(page, 'color')).toBeGreaterThan(0.8);
});

test.describe('by WebGL', () => {
  test.use({ webgl: true });
  test('print shows the drawing and hides controls, in light and dark mode', async ({ page }) => {
    await open_card(page, 1);
    await page.emulateMedia({ media: 'print', colorScheme: 'dark' });
    expect(await brightness(page, 'backgroundColor')).toBeGreaterThan(0.9);
    await expect(page.locator('nav')).toBeHidden();
    await expect(page.locator('#kind-1 .copy').first()).toBeHidden();
    await expect(page.locator('#kind-1 .paper svg')).toBeVisible();
    await expect(page.locator('#kind-1 canvas')).toBeHidden();
    expect((await page.pdf({ preferCSSPageSize: true, printBackground: true })).length).toBeGreaterThan(50_000);
  });
});

test('the keyboard reaches the answer first, and focus is visible', async ({ page }) => {
  await page.keyboard.press('Tab');
  await expect(page.locator('.skip')).toBeFocused();
  await page.keyboard.press('Tab');
  const outline = await page.evaluate(() => getComputedStyle(document.activeElement!).outlineStyle);
  expect(outline).toBe('solid');
});

// These tests use the comparison page, which has all parts but fewer rows, because axe needs some time for each row.
for (const [colorScheme, where] of [
  ['light', 'desk'],
  ['dark', 'phone'],
] as const) {
  test(`axe finds nothing, ${colorScheme}, on a ${where}`, async ({ page }) => {
    test.slow();
    const sections = await page.locator('main > section').evaluateAll((all) => all.map(({ id }) => id));
    await page.goto(compare_url());
    const parts = (await page.locator('main > section').evaluateAll((all) => all.map(({ id }) => id))).filter(
      (id) => id !== 'compare' && id !== 'toolchains',
    );
    expect(parts).toEqual(sections);
    if (where === 'phone') await page.setViewportSize(kPhone);
    await page.emulateMedia({ colorScheme });
    await open_card(page, 1);
    expect(await violations(page)).toEqual([]);
  });
}
