// SPDX-License-Identifier: Apache-2.0
// Choices filter rows and cards, are stored in the URL, and are restored from it.
import type { Page } from '@playwright/test';
import { kept_pairs, type Cell } from '../src/pairs_of_cell';
import type { Report } from '../src/report';
import { matcher } from '../src/search';
import { expect, test, url } from './page';

const names = (page: Page) => page.locator('.league tbody th');

// A cell of the league table.
const cell_at = (page: Page, report: Report, { lane, stratum }: Cell) =>
  page
    .locator('.league tbody tr')
    .nth(lane)
    .locator('td')
    .nth(stratum === null ? 0 : stratum + 1);

// The first cell of false negatives for which `is` returns true.
function find_cell(report: Report, is: (kept: number, count: number) => boolean): Cell | undefined {
  for (const { lane, stratum, false_negative } of report.rates) {
    const cell: Cell = { lane, stratum, kind: 'false_negative' };
    const kept = report.signatures.filter((signature) => kept_pairs(report, cell, signature).length).length;
    if (stratum !== null && is(kept, false_negative.count)) return cell;
  }
  return undefined;
}

test('a search needs all its words, and patterns match whole names', () => {
  const found = (query: string, name: string) => matcher(query)([name]);
  expect(found('moller f64', 'moller_1997/f64/cpu')).toBe(true);
  expect(found('f64  Moller', 'moller_1997/f64/cpu')).toBe(true);
  expect(found('moller f64', 'moller_1997/f32/cpu')).toBe(false);
  expect(found('*/f64/*', 'moller_1997/f64/cpu')).toBe(true);
  expect(found('f64/*', 'moller_1997/f64/cpu')).toBe(false);
  expect(found('*.*', 'moller_1997/f64/cpu')).toBe(false);
  expect(found('', 'anything')).toBe(true);
});

test('the league table finds lanes by words and patterns, even after a reload', async ({ page, report }) => {
  const search = page.locator('#league input[type=search]');
  await search.fill('moller f64');
  await expect(names(page)).toHaveText(
    report.lanes.filter((lane) => lane.id.startsWith('moller_1997/f64')).map((lane) => lane.id),
  );
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
  await expect(page.locator('.league thead th')).toHaveCount(3); // the lane, all strata, and one stratum
  await page.locator('nav a', { hasText: 'Extremes' }).click(); // a link within the page keeps the choices
  await expect(page).toHaveURL(/#extremes&/);
  await expect(names(page)).toHaveText(kept);
});

test('the filters apply to cards and signatures, even after a reload', async ({ page, report }) => {
  const shown = page.locator('.card:not([hidden])'),
    rows = page.locator('.signatures tbody tr');
  const search = page.locator('#kinds input[type=search]');
  const kinds = (is: (kind: Report['cards'][number]['kind']) => boolean) =>
    report.cards.filter(({ kind }) => is(kind)).length;
  await expect(shown).toHaveCount(report.cards.length);
  await page.locator('#kinds select').first().selectOption('moller_1997');
  const own = kinds(({ subject }) => subject === 'moller_1997');
  expect(own).toBeGreaterThan(0);
  expect(own).toBeLessThan(report.cards.length);
  await expect(shown).toHaveCount(own);
  for (const text of await rows.locator('td:nth-child(4)').allTextContents()) expect(text).toBe('moller_1997');
  await page.reload();
  await expect(shown).toHaveCount(own);
  await page.locator('#kinds select').first().selectOption('');
  // Searches by cause, source line, shape and lane; signatures are also found by their kinds.
  const { cause, line, shape, lanes } = report.cards.find(({ kind }) => kind.line && kind.cause === 'rounding')!.kind;
  const place = line.split('/').at(-1)!;
  for (const [query, is] of [
    ['overflow', (kind) => kind.cause === 'overflow'],
    [place, (kind) => kind.line.includes(place)],
    [`*${place}/${shape}`, (kind) => kind.line === line && kind.shape === shape],
    [`${cause} ${shape} ${place}`, (kind) => kind.line.includes(place) && kind.cause === cause && kind.shape === shape],
    [lanes[0], (kind) => kind.lanes.some((lane) => lane.includes(lanes[0]))],
  ] as [string, (kind: Report['cards'][number]['kind']) => boolean][]) {
    await search.fill(query);
    expect(kinds(is), query).toBeGreaterThan(0);
    expect(kinds(is), query).toBeLessThan(report.cards.length);
    await expect(shown, query).toHaveCount(kinds(is));
  }
  await search.fill('overflow');
  const overflowing = report.signatures.filter(({ cards }) =>
    cards.some((card) => report.cards[card].kind.cause === 'overflow'),
  ).length;
  await expect(page.locator('#signatures .readout')).toHaveText(
    new RegExp(`^${overflowing.toLocaleString('en-US')} shown`),
  );
  await search.fill('no such thing');
  await expect(shown).toHaveCount(0);
  await expect(page.locator('#kinds')).toContainText('No card passes the filter.');
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

test('a cell leads to its kept pairs', async ({ page, report }) => {
  const cell = find_cell(report, (kept) => kept > 0)!;
  const at = cell_at(page, report, cell);
  await at.locator('[data-kind=false_negative]').click();
  const kept = report.signatures.filter((signature) => kept_pairs(report, cell, signature).length);
  const note = page.locator('.cell-note');
  await expect(note).toContainText(
    `${report.lanes[cell.lane].id}, false negatives on ${report.strata[cell.stratum!].id}: ${kept.length} signature`,
  );
  await expect(note).toContainText(
    `graze repro ${kept_pairs(report, cell, kept[0])[0]} --lanes '${report.lanes[cell.lane].id}'`,
  );
  await expect(page.locator('.signatures tbody tr')).toHaveCount(Math.min(12, kept.length));
  for (const pair of await page.locator('.signatures tbody td:last-child').allTextContents())
    expect(pair).toMatch(new RegExp(`^${report.strata[cell.stratum!].id}:`));
  const kinds = new Set(
    kept
      .flatMap((signature) => signature.cards)
      .filter((card) => report.cards[card].kind.lanes.includes(report.lanes[cell.lane].id)),
  );
  await expect(page.locator('.card:not([hidden])')).toHaveCount(kinds.size);
  await expect(page.locator('#kinds h2')).toBeInViewport();
  await page.reload();
  await expect(note).toContainText(/keeps? such pairs/);
  await page.goBack();
  await expect(page.locator('.card:not([hidden])')).toHaveCount(report.cards.length);
});

test('a cell without kept pairs shows the command; one without errors, a message', async ({ page, report }) => {
  const lost = find_cell(report, (kept, count) => kept === 0 && count > 0);
  if (lost) {
    await cell_at(page, report, lost).locator('[data-kind=false_negative]').click();
    await expect(page.locator('.cell-note')).toContainText('no pair listed here shows such a verdict');
    await expect(page.locator('.cell-note')).toContainText(`graze fuzz --strata ${report.strata[lost.stratum!].id}`);
    await page.locator('.cell-note button', { hasText: 'Show all again' }).click();
    await expect(page.locator('.cell-note')).toBeEmpty();
  }
  const none = find_cell(report, (_, count) => count === 0)!;
  await cell_at(page, report, none).locator('[data-kind=false_negative]').click();
  await expect(page.locator('#league .readout')).toContainText('so there is no pair to show');
  await expect(page.locator('.cell-note')).toBeEmpty();
  await cell_at(
    page,
    report,
    find_cell(report, (kept) => kept > 0)!,
  ).focus();
  await page.keyboard.press('Enter');
  await expect(page.locator('.cell-note')).toContainText('wrong verdicts on');
});

test('the headings of the league table stay in view', async ({ page }) => {
  await page.locator('.league').scrollIntoViewIfNeeded();
  const scroller = page.locator('#league .scroller');
  await scroller.evaluate((element) => (element.scrollTop = element.scrollHeight));
  const [head, box] = [(await page.locator('.league thead th').nth(1).boundingBox())!, (await scroller.boundingBox())!];
  expect(Math.abs(head.y - box.y)).toBeLessThan(3);
  await expect(page.locator('.league tbody tr').last()).toBeInViewport();
});

test('if device lanes fail, a card has their program', async ({ report }) => {
  const fails_on = (card: Report['cards'][number], device: boolean) =>
    card.verdicts.some(
      ({ lane, wrong }) =>
        wrong &&
        report.lanes[lane].target.startsWith('cuda') === device &&
        card.kind.lanes.includes(report.lanes[lane].id),
    );
  const has = (card: Report['cards'][number], program: string) => card.snippets.some(({ label }) => label === program);
  for (const card of report.cards) {
    // On the pair shown, some lanes of the subject may fail for another reason than the kind's. The card may
    // then lack a program.
    const mixed = card.verdicts.some(
      ({ lane, wrong }) =>
        wrong && report.lanes[lane].algorithm === card.kind.subject && !card.kind.lanes.includes(report.lanes[lane].id),
    );
    for (const [program, device] of [
      ['cuda', true],
      ['cpp', false],
    ] as const) {
      if (has(card, program)) expect(fails_on(card, device)).toBe(true);
      else if (!mixed) expect(fails_on(card, device), `${card.kind.key} ${program}`).toBe(false);
    }
  }
  expect(report.cards.some((card) => has(card, 'cuda') && has(card, 'cpp'))).toBe(true);
});
