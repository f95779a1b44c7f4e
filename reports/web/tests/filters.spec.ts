// SPDX-License-Identifier: Apache-2.0
// What is chosen reaches rows and cards, stands in the URL, and comes back with it.
import type { Page } from '@playwright/test';
import { kept_pairs, type Cell } from '../src/pairs_of_cell';
import type { Report } from '../src/report';
import { matcher } from '../src/search';
import { expect, test, url } from './page';

const names = (page: Page) => page.locator('.league tbody th');

// A cell of the league table.
const cell_at = (page: Page, report: Report, { lane, stratum }: Cell) =>
  page.locator('.league tbody tr').nth(lane).locator('td').nth(stratum === null ? 0 : stratum + 1);

// The first cell of that kind of error of which `is` holds.
function find_cell(report: Report, is: (kept: number, count: number) => boolean): Cell | undefined {
  for (const { lane, stratum, false_negative } of report.rates) {
    const cell: Cell = { lane, stratum, kind: 'false_negative' };
    const kept = report.signatures.filter((signature) => kept_pairs(report, cell, signature).length).length;
    if (stratum !== null && is(kept, false_negative.count)) return cell;
  }
  return undefined;
}

test('a search takes all words, and patterns of whole names', () => {
  const found = (query: string, name: string) => matcher(query)([name]);
  expect(found('moller f64', 'moller_1997/f64/cpu')).toBe(true);
  expect(found('f64  Moller', 'moller_1997/f64/cpu')).toBe(true);
  expect(found('moller f64', 'moller_1997/f32/cpu')).toBe(false);
  expect(found('*/f64/*', 'moller_1997/f64/cpu')).toBe(true);
  expect(found('f64/*', 'moller_1997/f64/cpu')).toBe(false);
  expect(found('*.*', 'moller_1997/f64/cpu')).toBe(false);
  expect(found('', 'anything')).toBe(true);
});

test('the league table finds lanes by words and patterns, again after a reload', async ({ page, report }) => {
  const search = page.locator('#league input[type=search]');
  await search.fill('moller f64');
  await expect(names(page)).toHaveText(report.lanes.filter((lane) => lane.id.startsWith('moller_1997/f64')).map((lane) => lane.id));
  await search.fill('*/f64/*');
  await page.locator('#league select').first().selectOption('false_negative');
  await page.locator('#league select').nth(1).selectOption({ label: report.strata[1].id });
  await page.locator('#league .chips button', { hasText: /^cpu-fma$/ }).click();
  const kept = report.lanes.filter((lane) => lane.scalar === 'f64' && lane.target !== 'cpu-fma').map((lane) => lane.id);
  await expect(names(page)).toHaveText(kept);
  await page.reload();
  await expect(names(page)).toHaveText(kept);
  await expect(search).toHaveValue('*/f64/*');
  await expect(page.locator('#league select').first()).toHaveValue('false_negative');
  await expect(page.locator('.league thead th')).toHaveCount(3);  // lane, all strata, one
  await page.locator('nav a', { hasText: 'Extremes' }).click();   // a link to a place keeps what is chosen
  await expect(page).toHaveURL(/#extremes&/);
  await expect(names(page)).toHaveText(kept);
});

test('the filters of signatures reach the cards, again after a reload', async ({ page, report }) => {
  const shown = page.locator('.card:not([hidden])');
  await expect(shown).toHaveCount(report.cards.length);
  await page.locator('#signatures select').first().selectOption('moller_1997');
  const own = report.cards.filter((card) => report.signatures[card.signature].algorithm === 'moller_1997').length;
  expect(own).toBeGreaterThan(0);
  expect(own).toBeLessThan(report.cards.length);
  await expect(shown).toHaveCount(own);
  await page.reload();
  await expect(shown).toHaveCount(own);
  await page.locator('#signatures input[type=search]').fill('no such thing');
  await expect(shown).toHaveCount(0);
  await expect(page.locator('#signatures')).toContainText('No card passes the filter.');
});

test('#kind-N opens that card', async ({ page }) => {
  await page.goto('about:blank');
  await page.goto(`${url()}#kind-4`);
  await expect(page.locator('#kind-4')).toHaveAttribute('open', '');
  await expect(page.locator('#kind-4 summary').first()).toBeInViewport();
  await page.evaluate(() => (location.hash = '#kind-5'));
  await expect(page.locator('#kind-5')).toHaveAttribute('open', '');
  await expect(page.locator('#kind-5 summary').first()).toBeInViewport();
});

test('a cell leads to the pairs kept of it', async ({ page, report }) => {
  const cell = find_cell(report, (kept) => kept > 0)!;
  const at = cell_at(page, report, cell);
  await at.locator('[data-kind=false_negative]').click();
  const kept = report.signatures.filter((signature) => kept_pairs(report, cell, signature).length);
  const note = page.locator('.cell-note');
  await expect(note).toContainText(`${report.lanes[cell.lane].id}, false negatives on ${report.strata[cell.stratum!].id}: ${kept.length} signatures`);
  await expect(note).toContainText(`graze repro ${kept_pairs(report, cell, kept[0])[0]} --lanes '${report.lanes[cell.lane].id}'`);
  await expect(page.locator('.signatures tbody tr')).toHaveCount(Math.min(12, kept.length));
  for (const pair of await page.locator('.signatures tbody td:last-child').allTextContents()) expect(pair).toMatch(new RegExp(`^${report.strata[cell.stratum!].id}:`));
  await expect(page.locator('.card:not([hidden])')).toHaveCount(kept.filter((signature) => signature.card !== null).length);
  await expect(page.locator('#signatures h2')).toBeInViewport();
  await page.reload();
  await expect(note).toContainText('signatures keep such pairs');
  await page.goBack();
  await expect(page.locator('.card:not([hidden])')).toHaveCount(report.cards.length);
});

test('a cell without a kept pair gives the command, one without errors says so', async ({ page, report }) => {
  const lost = find_cell(report, (kept, count) => kept === 0 && count > 0);
  if (lost) {
    await cell_at(page, report, lost).locator('[data-kind=false_negative]').click();
    await expect(page.locator('.cell-note')).toContainText('no pair listed here shows it');
    await expect(page.locator('.cell-note')).toContainText(`graze fuzz --strata ${report.strata[lost.stratum!].id}`);
    await page.locator('.cell-note button', { hasText: 'Show all again' }).click();
    await expect(page.locator('.cell-note')).toBeEmpty();
  }
  const none = find_cell(report, (_, count) => count === 0)!;
  await cell_at(page, report, none).locator('[data-kind=false_negative]').click();
  await expect(page.locator('#league .readout')).toContainText('so no pair shows one');
  await expect(page.locator('.cell-note')).toBeEmpty();
  await cell_at(page, report, find_cell(report, (kept) => kept > 0)!).focus();
  await page.keyboard.press('Enter');
  await expect(page.locator('.cell-note')).toContainText('wrong verdicts on');
});

test('the heads of the league table stay', async ({ page }) => {
  await page.locator('.league').scrollIntoViewIfNeeded();
  const scroller = page.locator('#league .scroller');
  await scroller.evaluate((element) => (element.scrollTop = element.scrollHeight));
  const [head, box] = [(await page.locator('.league thead th').nth(1).boundingBox())!, (await scroller.boundingBox())!];
  expect(Math.abs(head.y - box.y)).toBeLessThan(3);
  await expect(page.locator('.league tbody tr').last()).toBeInViewport();
});

test('where lanes of a device fail, a card has their program', async ({ report }) => {
  const fails_on = (card: Report['cards'][number], device: boolean) => card.verdicts.some(({ lane, wrong }) => wrong && report.lanes[lane].target.startsWith('cuda') === device
    && report.lanes[lane].algorithm === report.signatures[card.signature].algorithm);
  for (const card of report.cards) {
    expect(card.snippets.some(({ label }) => label === 'cuda')).toBe(fails_on(card, true));
    expect(card.snippets.some(({ label }) => label === 'cpp')).toBe(fails_on(card, false));
  }
  expect(report.cards.some((card) => fails_on(card, true) && fails_on(card, false))).toBe(true);
});
