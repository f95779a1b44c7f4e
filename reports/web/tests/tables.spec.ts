// SPDX-License-Identifier: Apache-2.0
import type { Report } from '../src/report';
import { doubles_url, expect, test } from './page';

const column_of = (title: string) => `//thead//th[.//span[normalize-space()="${title}"]]`;

test('the league table holds the report’s numbers, with intervals', async ({ page, report }) => {
  const rows = page.locator('.league tbody tr');
  await expect(rows).toHaveCount(report.lanes.length);
  const rate =
    report.rates.find((r) => r.stratum === 0 && r.wrong.count > 0) ?? report.rates.find((r) => r.stratum === 0)!;
  const has_all = report.rates.some((r) => r.stratum === null);
  const cell = rows
    .nth(rate.lane)
    .locator('td')
    .nth(has_all ? 1 : 0);
  const title = (await cell.getAttribute('title'))!;
  expect(title).toContain(`${report.lanes[rate.lane].id} on ${report.strata[0].id}`);
  expect(title).toContain(
    `false positives ${rate.false_positive.count.toLocaleString('en-US')} of ${rate.false_positive.of.toLocaleString('en-US')}`,
  );
  expect(title).toMatch(/95 %: [<0-9.]/);
  await cell.hover();
  await expect(page.locator('#league .readout')).toHaveText(title);
});

test('a campaign of both coordinate types has a switch, and shows errors due to storing', async ({ page }) => {
  test.skip(!process.env.GRAZE_DOUBLES, 'no such campaign');
  await expect(page.locator('#league label', { hasText: 'Coordinates' })).toHaveCount(0); // only float32
  await page.goto(doubles_url());
  await page.waitForSelector('#league');
  const report = JSON.parse((await page.locator('#report').textContent())!) as Report;
  const heads = () => page.locator('.league thead .upright').allTextContents();
  const names = report.strata.map((stratum) => stratum.id);
  expect(names).toContain('stored/f64');
  expect(await heads()).toEqual(['all strata', ...names]);
  const types = page.locator('#league label', { hasText: 'Coordinates' }).locator('select');
  await types.selectOption('f64');
  expect(await heads()).toEqual(['all strata', ...names.filter((name) => name.endsWith('/f64'))]);
  const stratum = names.indexOf('stored/f64');
  const rate = report.rates.find(
    (row) => row.stratum === stratum && report.lanes[row.lane].id === 'moller_1997/f32/cpu',
  )!;
  expect(rate.stored).toBeGreaterThan(30);
  expect(rate.stored).toBeLessThanOrEqual(rate.wrong.count);
  await expect(page.locator(`.league td[title*="moller_1997/f32/cpu on stored/f64"]`)).toHaveAttribute(
    'title',
    new RegExp(`wrong by storing in float32 ${rate.stored}$`),
  );
  await types.selectOption('f32');
  expect(await heads()).toEqual(['all strata', ...names.filter((name) => !name.endsWith('/f64'))]);
});

test('the league table sorts by a column, down and up', async ({ page, report }) => {
  const head = page.locator(
    `.league ${column_of(report.strata[1].id)}`.replace('.league ', '//table[contains(@class,"league")]'),
  );
  const shares = async () => {
    const names = await page.locator('.league tbody th').allTextContents();
    return names.map(
      (name) => report.rates.find((r) => report.lanes[r.lane].id === name && r.stratum === 1)!.wrong.share,
    );
  };
  await head.locator('button').click();
  await expect(head).toHaveAttribute('aria-sort', 'descending');
  const down = await shares();
  expect(down).toEqual([...down].sort((a, b) => b - a));
  expect(down[0]).toBeGreaterThan(down[down.length - 1]);
  await expect(head.locator('button')).toBeFocused();
  await page.keyboard.press('Enter');
  await expect(head).toHaveAttribute('aria-sort', 'ascending');
  const up = await shares();
  expect(up).toEqual([...up].sort((a, b) => a - b));
});

test('the league table filters by text, scalar, target and stratum', async ({ page, report }) => {
  const names = page.locator('.league tbody th');
  await page.locator('#league input[type=search]').fill('moller');
  await expect(names).toHaveCount(report.lanes.filter((lane) => lane.id.includes('moller')).length);
  await page.locator('#league .chips button', { hasText: /^f64$/ }).click();
  await expect(names).toHaveCount(
    report.lanes.filter((lane) => lane.id.includes('moller') && lane.scalar === 'f32').length,
  );
  await page.locator('#league .chips button', { hasText: /^cpu$/ }).click();
  for (const name of await names.allTextContents()) expect(name).toMatch(/^moller_1997\/f32\/(?!cpu$)/);
  await page.locator('#league select').nth(1).selectOption({ label: report.strata[2].id });
  const heads = await page.locator('.league thead th').allTextContents();
  expect(heads.filter((head) => report.strata.some((s) => s.id === head))).toEqual([report.strata[2].id]);
  await page.locator('#league input[type=search]').fill('no such lane');
  await expect(page.locator('.league .empty')).toBeVisible();
});

test('the arrow keys walk through the cells', async ({ page }) => {
  const cells = page.locator('.league tbody tr').first().locator('td');
  await cells.first().focus();
  await page.keyboard.press('ArrowRight');
  await expect(cells.nth(1)).toBeFocused();
  await page.keyboard.press('ArrowDown');
  await expect(page.locator('.league tbody tr').nth(1).locator('td').nth(1)).toBeFocused();
  await expect(page.locator('#league .readout')).toContainText('false negatives');
});

test('cells are readable on their colour', async ({ page }) => {
  const worst = await page.locator('.rate span').evaluateAll((spans) => {
    const luminance = (colour: string) => {
      const [r, g, b] = colour
        .match(/[\d.]+/g)!
        .map(Number)
        .map((c) => c / 255)
        .map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    return Math.min(
      ...spans.map((span) => {
        const style = getComputedStyle(span);
        const [x, y] = [luminance(style.color), luminance(style.backgroundColor)];
        return (Math.max(x, y) + 0.05) / (Math.min(x, y) + 0.05);
      }),
    );
  });
  expect(worst).toBeGreaterThanOrEqual(4.5);
});

test('equal results of the CPU and CUDA without contraction are shown as equal', async ({ page, report }) => {
  const rows = report.side_by_side.filter((side) => side.kind === 'cpu-nofma');
  const differ = rows.filter((side) => side.strata.some((entry) => entry.stratum === null && entry.differs?.count));
  const table = page.locator('#side-by-side .beside-one').first();
  await expect(table.locator('tbody tr')).toHaveCount(rows.length);
  await expect(table.locator('.good')).toHaveCount(rows.length - differ.length);
  await expect(table.locator('td.bad')).toHaveCount(differ.length);
});

test('signatures sort and filter, and lead to their kinds', async ({ page, report }) => {
  const rows = page.locator('.signatures tbody tr');
  await page.locator('#kinds select').first().selectOption('moller_1997');
  for (const text of await rows.locator('td:nth-child(4)').allTextContents()) expect(text).toBe('moller_1997');
  await page.locator('#kinds select').first().selectOption('');
  await page.locator('#kinds input[type=search]').fill('coplanar');
  expect(await rows.count()).toBeGreaterThan(0);
  for (const text of await rows.locator('td:nth-child(7)').allTextContents()) expect(text).toBe('coplanar');
  await page.locator('#kinds input[type=search]').fill('');
  const pairs = page.locator('.signatures thead button', { hasText: 'Pairs' });
  await pairs.click();
  await expect(rows.first().locator('td:nth-child(2)')).toHaveText(report.signatures[0].count.toLocaleString('en-US'));
  await pairs.click();
  const least = Math.min(...report.signatures.map((s) => s.count));
  await expect(rows.first().locator('td:nth-child(2)')).toHaveText(least.toLocaleString('en-US'));
  await pairs.click();
  const last = report.cards.length;
  const more = page.locator('#signatures .more');
  const link = page.locator('.signatures .link', { hasText: new RegExp(`^kind ${last}$`) }).first();
  while (!(await link.count()) && (await more.isVisible())) await more.click();
  const row = report.signatures.find(({ cards }) => cards.includes(last - 1))!;
  await expect(
    rows
      .filter({ has: page.locator('.link', { hasText: new RegExp(`^kind ${last}$`) }) })
      .first()
      .locator('.link'),
  ).toHaveText(row.cards.map((card) => `kind ${card + 1}`));
  await link.click();
  await expect(page.locator(`#kind-${last}`)).toHaveAttribute('open', '');
  await expect(page.locator(`#kind-${last} .truth`).first()).toBeInViewport();
});

test('the league table fades out at its right edge if it continues there', async ({ page }) => {
  const table = page.locator('#league .scroller');
  const mask = () => table.evaluate((one) => getComputedStyle(one).maskImage);
  await page.setViewportSize({ width: 390, height: 844 });
  await expect.poll(mask).toContain('gradient');
  await table.evaluate((one) => one.scrollTo({ left: one.scrollWidth }));
  await expect.poll(mask).toBe('none');
  await page.setViewportSize({ width: 2400, height: 844 }); // nothing continues behind the edge
  await expect.poll(mask).toBe('none');
});
