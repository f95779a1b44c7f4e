// SPDX-License-Identifier: Apache-2.0
// The page of `graze view` under test, which must never fetch anything or write to the console.
import { execFileSync } from 'node:child_process';
import { pathToFileURL } from 'node:url';
import { expect, test as base, type Page } from '@playwright/test';
import { watch, without_webgl } from './page';

export const file = () => process.env.GRAZE_VIEW!;
export const url = () => pathToFileURL(file()).href;
export const doubles_url = () => pathToFileURL(process.env.GRAZE_VIEW_DOUBLES!).href;

// Without WebGL, except in tests that need it, because WebGL takes most of the time if there is no GPU.
export const test = base.extend<{ webgl: boolean; of_doubles: boolean; viewer: Page }>({
  webgl: [false, { option: true }],
  of_doubles: [false, { option: true }],
  viewer: async ({ page, webgl, of_doubles }, use) => {
    if (!webgl) await page.addInitScript(without_webgl);
    test.skip(!file(), 'this build has no viewer');
    const address = of_doubles ? doubles_url() : url();
    const expect_quiet = watch(page, [address]);
    await page.goto(address);
    await page.waitForSelector('#replayed');
    await use(page);
    expect_quiet();
  },
});

export const coordinate = (page: Page, c: number) => page.locator(`[data-coordinate="${c}"]`);
export const verdict = (page: Page, lane: string) => page.locator(`[data-lane="${lane}"]`);
export const name = (page: Page) => page.locator('h1').textContent();

// The verdicts on the page, without their marks.
export const verdicts = (page: Page) =>
  page
    .locator('[data-lane]')
    .evaluateAll((cells) =>
      Object.fromEntries(
        cells.map((cell) => [cell.getAttribute('data-lane')!, cell.textContent!.replace(/[^a-z]/g, '')]),
      ),
    );

// Pastes the text into the first coordinate.
export const paste = (page: Page, text: string) =>
  coordinate(page, 0).evaluate((field, pasted) => {
    const data = new DataTransfer();
    data.setData('text', pasted);
    field.dispatchEvent(new ClipboardEvent('paste', { clipboardData: data, cancelable: true, bubbles: true }));
  }, text);

// The output of `graze check` for the pair that is shown.
export async function checked(page: Page) {
  await page.locator('#copies button', { hasText: 'check line' }).click();
  const line = (await page.locator('.copied code').textContent())!;
  return JSON.parse(
    execFileSync(process.env.GRAZE!, ['check', '-', '--json', '--executor', 'twin'], { input: line, encoding: 'utf8' }),
  ) as { truth: { verdict: string; contact: string }; lanes: Record<string, string>; coordinates?: string };
}

// Requires that the page's verdicts and truth are those of `graze check`.   Returns: the output of `graze check`.
export async function expect_as_checked(page: Page) {
  const native = await checked(page);
  const shown = Object.entries(await verdicts(page));
  expect(shown.length).toBeGreaterThan(30);
  for (const [lane, said] of shown) expect(native.lanes[lane], lane).toBe(said);
  await expect(page.locator('#truth')).toContainText(`Truth: ${native.truth.verdict}`);
  return native;
}

// Takes the step, and waits for another pair.
export async function to_another_pair(page: Page, step: () => Promise<void>) {
  const before = await name(page);
  await step();
  await expect.poll(() => name(page), { timeout: 30_000 }).not.toBe(before);
}

// Checks that "Copy as" gives these texts, by kind.
export async function expect_copies(page: Page, copies: Record<string, string>) {
  for (const [kind, text] of Object.entries(copies)) {
    await page.locator('#copies button').getByText(kind, { exact: true }).click();
    await expect(page.locator('.copied code')).toContainText(text);
  }
}

export { expect };
