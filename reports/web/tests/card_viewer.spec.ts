// SPDX-License-Identifier: Apache-2.0
// Tests the viewer that a card opens over the report.
import { readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { test as unwatched, type Page } from '@playwright/test';
import type { Report } from '../src/report';
import type { Stored } from '../src/viewer/data';
import { doubles_url, expect, open_card, test, url, violations, without_webgl } from './page';

test.skip(() => !process.env.GRAZE_VIEW, 'this build has no viewer');

const viewer = (page: Page) => page.locator('#viewer');
const open_button = (page: Page, number: number) => page.locator(`#kind-${number} .in-viewer`);

// The viewer must agree with the card on the verdicts of all lanes that both have.
async function expect_verdicts_of(page: Page, report: Report, number: number) {
  const { truth, verdicts } = report.cards[number - 1];
  await expect(viewer(page).locator('h1')).toContainText(`Card ${number}: `);
  await expect(viewer(page).locator('#truth')).toContainText(`Truth: ${truth.verdict}`);
  const shown = await viewer(page)
    .locator('[data-lane]')
    .evaluateAll((cells) =>
      Object.fromEntries(
        cells.map((cell) => [
          cell.getAttribute('data-lane')!,
          `${cell.classList.contains('bad') ? 'wrong' : 'right'}: ${cell.textContent!.replace(/[^a-z]/g, '')}`,
        ]),
      ),
    );
  const stored = verdicts
    .map(({ lane, verdict, wrong }) => [report.lanes[lane].id, `${wrong ? 'wrong' : 'right'}: ${verdict}`] as const)
    .filter(([lane]) => lane in shown); // the viewer has no cpu-fma lanes, for example
  expect(stored.length).toBeGreaterThan(10);
  expect(shown).toMatchObject(Object.fromEntries(stored));
}

test('the viewer opens on a card, agrees with the card, and leads back', async ({ page, report }) => {
  const { lanes } = (JSON.parse((await page.locator('#view').textContent())!) as { f32: Stored }).f32.replay;
  const in_viewer = (card: Report['cards'][number]) => card.kind.lanes.some((lane) => lanes.includes(lane));
  const first = 1 + report.cards.findIndex(in_viewer),
    without = 1 + report.cards.findIndex((card) => !in_viewer(card));
  await open_card(page, first);
  await expect(viewer(page)).toBeHidden();
  await open_button(page, first).scrollIntoViewIfNeeded();
  const scrolled = await page.evaluate(() => scrollY);
  await open_button(page, first).press('Enter'); // by keyboard
  await expect(viewer(page).locator('#replayed')).toContainText('Same as the native build');
  await expect_verdicts_of(page, report, first);
  expect(report.cards[first - 1].kind.lanes).toContain(
    await viewer(page).locator('[data-lane][aria-pressed="true"]').getAttribute('data-lane'),
  );
  await expect.poll(() => page.url()).toMatch(new RegExp(`#kind-${first}&.*p=[0-9a-f]{144}`));
  // Keys work in the viewer, and Escape closes only the help.
  await page.keyboard.press('h');
  await expect(page.locator('#help')).toBeVisible();
  await page.keyboard.press('Escape');
  await expect(page.locator('#help')).toBeHidden();
  await page.keyboard.press('n');
  await expect_verdicts_of(page, report, first + 1);
  await page.keyboard.press('Escape');
  await expect(viewer(page)).toBeHidden();
  await expect(open_button(page, first)).toBeFocused();
  expect(await page.evaluate(() => scrollY)).toBe(scrolled);
  expect(page.url()).not.toContain('p=');
  await page.keyboard.press('h'); // keys do nothing while the viewer is closed
  await expect(page.locator('#help')).toBeHidden();
  if (without > 0) {
    // open another card in the same viewer
    await open_card(page, without);
    await open_button(page, without).click();
    await expect_verdicts_of(page, report, without);
    await expect(viewer(page).locator('.message')).toContainText(
      'are not in the viewer, because another compiler built it',
    );
    await page.goBack();
    await expect(viewer(page)).toBeHidden();
  }
});

test('cards of both coordinate types open in the viewer', async ({ page }) => {
  await page.goto(doubles_url());
  const report = JSON.parse((await page.locator('#report').textContent())!) as Report;
  const parts = JSON.parse((await page.locator('#view').textContent())!) as Record<string, Stored>;
  const number_of = (type: string) => 1 + report.cards.findIndex((card) => card.coordinates === type);
  for (const [type, digits, beside] of [
    ['f64', 288, 'exact/f64/cpu'],
    ['f32', 144, 'exact/f32/cpu'],
    ['f64', 288, 'exact/f64/cpu'],
  ] as const) {
    const number = number_of(type);
    expect(number, `a card of ${type}`).toBeGreaterThan(0);
    await open_card(page, number);
    await open_button(page, number).click();
    await expect(viewer(page).locator('#replayed')).toContainText('Same as the native build');
    await expect(viewer(page).locator('h1')).toContainText(`Card ${number}: `);
    await expect(viewer(page).locator('#truth')).toContainText(`Truth: ${report.cards[number - 1].truth.verdict}`);
    await expect(viewer(page).locator(`[data-lane="${beside}"]`)).toHaveText(report.cards[number - 1].truth.verdict);
    await expect.poll(() => page.url()).toMatch(new RegExp(`#kind-${number}&.*p=[0-9a-f]{${digits}}(&|$)`));
    const stored = report.cards[number - 1].verdicts.map(({ lane, verdict }) => ({
        id: report.lanes[lane].id,
        verdict,
      })),
      both = stored.filter(({ id }) => parts[type].replay.lanes.includes(id));
    expect(both.length).toBeGreaterThan(2);
    for (const { id, verdict } of both)
      await expect(viewer(page).locator(`[data-lane="${id}"]`)).toContainText(verdict);
    await page.keyboard.press('Escape');
    await expect(viewer(page)).toBeHidden();
  }
});

test('on a phone, a link opens the viewer with its changed pair, and Back leads to the card', async ({ page }) => {
  await page.setViewportSize({ width: 390, height: 844 });
  await open_card(page, 1);
  await open_button(page, 1).click();
  await expect(viewer(page).locator('#replayed')).toBeVisible();
  const before = page.url();
  await page.keyboard.press('w');
  await expect(viewer(page).locator('h1')).toContainText('changed');
  const moved = await viewer(page).locator('[data-coordinate="1"]').inputValue();
  await expect.poll(() => page.url()).not.toBe(before);
  const link = page.url();
  await page.goto('about:blank');
  await page.goto(link);
  await expect(viewer(page).locator('[data-coordinate="1"]')).toHaveValue(moved);
  await expect(viewer(page).locator('h1')).toHaveText('the pair of a link');
  expect(await viewer(page).evaluate((dialog) => dialog.scrollWidth)).toBeLessThanOrEqual(390);
  expect(await violations(page, '#viewer')).toEqual([]);
  await viewer(page).locator('button', { hasText: 'Back to the report' }).click();
  await expect(viewer(page)).toBeHidden();
  await expect(page.locator('#kind-1')).toHaveAttribute('open', '');
  expect(page.url()).toMatch(/#kind-1$/);
});

unwatched('without the module, no card has the button, and the page explains why', async ({ page }) => {
  const altered = join(dirname(process.env.GRAZE_REPORT!), 'without_viewer.html');
  writeFileSync(
    altered,
    readFileSync(new URL(url()), 'utf8').replace(/(<script type="application\/json" id="view">)[^<]*/, '$1null'),
  );
  await page.addInitScript(without_webgl);
  await page.goto(pathToFileURL(altered).href);
  await expect(page.locator('#kinds')).toContainText(
    'Cards do not open in the viewer, because graze was built without the compiler for WebAssembly that the viewer needs.',
  );
  await expect(page.locator('.card-body').first()).toBeVisible();
  await expect(page.locator('.in-viewer')).toHaveCount(0);
});
