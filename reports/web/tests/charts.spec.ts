// SPDX-License-Identifier: Apache-2.0
import { power_of_two } from '../src/format';
import { times_fill } from '../src/heat';
import type { Report, Threshold } from '../src/report';
import { expect, pixels, test } from './page';

const kLines = '#margin-chart svg g[data-mark="line"] path';

// On the log axis, a lane has a line on each side of zero on which it was wrong at least once.
const lines_of = (report: Report, shown: (lane: Report['lanes'][number]) => boolean) =>
  report.margins
    .filter((row) => row.stratum === null && shown(report.lanes[row.lane]))
    .reduce(
      (lines, row) =>
        lines +
        ['disjoint', 'intersects'].filter((side) => row.points.some((p) => p.side === side && p.wrong.count > 0))
          .length,
      0,
    );

test('errors against margin: one line for each lane, thresholds with their bounds', async ({ page, report }) => {
  await page.locator('#margin-chart').scrollIntoViewIfNeeded();
  const published = report.lanes.filter((lane) => !lane.exact && lane.scalar === 'f32' && lane.target === 'cpu');
  await expect(page.locator(kLines)).toHaveCount(lines_of(report, (lane) => published.includes(lane)));
  for (const d of await page.locator(kLines).evaluateAll((paths) => paths.map((path) => path.getAttribute('d'))))
    expect(d).not.toContain('NaN');
  await expect(page.locator('.thresholds tbody tr')).toHaveCount(published.length);
  const certified = published.flatMap((lane) => {
    const t = report.thresholds.find(
      (one) => report.lanes[one.lane] === lane && one.group === null && one.stratum === null,
    )!;
    return [t.disjoint, t.intersects].filter((side) => side.exponent !== null && side.above > 0);
  });
  const titles = await page.locator('#margin-chart title').allTextContents();
  expect(titles.filter((title) => title.includes('no error in'))).toHaveLength(certified.length);
});

test('lanes can be chosen, and the share is drawn on either axis', async ({ page, report }) => {
  await page.locator('#margin-chart').scrollIntoViewIfNeeded();
  const drawn = await pixels(page.locator('#margin-chart'));
  await page.locator('#margins .chips button', { hasText: /^f64$/ }).click();
  await expect(page.locator(kLines)).toHaveCount(lines_of(report, (lane) => !lane.exact && lane.target === 'cpu'));
  expect(await pixels(page.locator('#margin-chart'))).not.toBe(drawn);
  await page.locator('#margins .chips button', { hasText: /^f64$/ }).click();
  await page.locator('#margins select').first().selectOption('linear');
  await expect(page.locator('#margin-chart')).toContainText('50 %');
});

test('pointing at the chart shows the lane, the margin and the interval', async ({ page }) => {
  await page.locator('#margin-chart').scrollIntoViewIfNeeded();
  const box = (await page.locator('#margin-chart svg').first().boundingBox())!;
  await page.mouse.move(box.x + 0.56 * box.width, box.y + 0.15 * box.height, { steps: 5 });
  await expect(page.locator('#margin-chart g[aria-label="tip"]')).toContainText('95 %');
});

test('thresholds can be shown for a group of strata or a stratum', async ({ page, report }) => {
  const shown = async () => (await page.locator('.thresholds tbody tr').allInnerTexts()).map((row) => row.split(/\t/));
  const words = (t: Threshold) =>
    t.exponent !== null
      ? power_of_two(t.exponent)
      : t.largest === null
        ? 'no such pairs'
        : `wrong at ${power_of_two(t.largest)}`;
  const expected = (is: (t: Report['thresholds'][number]) => boolean) =>
    report.thresholds
      .filter((t) => {
        const lane = report.lanes[t.lane];
        return is(t) && !lane.exact && lane.scalar === 'f32' && lane.target === 'cpu';
      })
      .map((t) => [words(t.disjoint), words(t.intersects)]);
  const trust = page.locator('#margins select').nth(1);
  const found: string[] = [];
  for (const [value, is] of [
    [report.groups[0].id, (t) => t.group === 0],
    ['all', (t) => t.group === null && t.stratum === null],
    [`stratum ${report.strata[1].id}`, (t) => t.stratum === 1],
  ] as [string, (t: Report['thresholds'][number]) => boolean][]) {
    await trust.selectOption(value);
    expect((await shown()).map((row) => [row[1], row[4]])).toEqual(expected(is));
    found.push(JSON.stringify(expected(is)));
  }
  expect(new Set(found).size).toBe(3);
  await page.reload();
  await expect(trust).toHaveValue(`stratum ${report.strata[1].id}`);
});

test('extremes: a cell for every exponent with pairs, thin if they are few', async ({ page, report }) => {
  for (const kind of ['scale', 'offset'] as const) {
    const rows = report.extremes.filter((row) => row.kind === kind && report.lanes[row.lane].target === 'cpu');
    const cells = rows.reduce((sum, row) => sum + row.cells.length, 0);
    if (!cells) continue;
    await page.locator(`#extremes-${kind}`).scrollIntoViewIfNeeded();
    await expect(page.locator(`#extremes-${kind} g[data-mark="rect"] rect`)).toHaveCount(cells);
    const few = rows.reduce((sum, row) => sum + row.cells.filter((cell) => cell.wrong.of < 100).length, 0);
    expect(few).toBeGreaterThan(0);
    const heights = await page
      .locator(`#extremes-${kind} g[data-mark="rect"] rect`)
      .evaluateAll((rects) => rects.map((rect) => rect.getBoundingClientRect().height));
    expect(heights.filter((height) => height < 8)).toHaveLength(few);
    await expect(page.locator(`#extremes-${kind} svg`).first()).toHaveAttribute(
      'aria-label',
      /(as right as at|errs on none|not settled)/,
    );
    const fills = await page
      .locator(`#extremes-${kind} g[data-mark="rect"] rect`)
      .evaluateAll((rects) => [...new Set(rects.map((rect) => getComputedStyle(rect).fill))]);
    const shades = rows.flatMap((row) => row.cells.map(({ times }) => times_fill(times?.[0] ?? times?.[1] ?? 0)));
    expect(fills.length).toBe(new Set(shades).size);
  }
});

test('shades of extremes differ for ratios from 1 to 32', () => {
  const shades = [1, 1.5, 2, 4, 8, 16, 32].map(times_fill);
  expect(new Set(shades).size).toBe(shades.length);
  expect([0, 0.5, 1].map(times_fill)).toEqual(Array(3).fill(times_fill(1)));
  expect(times_fill(1000)).toBe(times_fill(32));
});

test('each lane has a text on scale, offset, flatness and needles', async ({ page, report }) => {
  const rows = page.locator('#extremes .reach tbody tr');
  const lanes = report.lanes.flatMap((lane, i) => (lane.target === 'cpu' ? [i] : []));
  await expect(rows).toHaveCount(lanes.length);
  for (const [place, lane] of lanes.entries()) {
    for (const kind of ['scale', 'offset'] as const)
      await expect(rows.nth(place)).toContainText(
        report.extremes.find((row) => row.lane === lane && row.kind === kind)!.says,
      );
  }
  // The first lanes of pareto.json are also measured on flat pairs and needles.
  await expect(rows.first()).toContainText(/(as right as at 1|errs on none|not settled).*2\^/);
});

test('lanes that differ from cpu have a curve against the margin', async ({ page, report }) => {
  await page.locator('#differ-chart').scrollIntoViewIfNeeded();
  const drawn = report.margins
    .filter((row) => report.lanes[row.lane].scalar === 'f32' && report.lanes[row.lane].target === 'cuda-fma')
    .flatMap((row) =>
      ['disjoint', 'intersects'].filter((side) => row.points.some((p) => p.side === side && p.differs?.count)),
    );
  expect(drawn.length).toBeGreaterThan(5);
  await expect(page.locator('#differ-chart svg g[data-mark="line"] path')).toHaveCount(drawn.length);
});
