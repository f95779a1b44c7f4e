// SPDX-License-Identifier: Apache-2.0
// The page of `graze view` under test. In every test it must fetch nothing and leave the console clean.
import { execFileSync } from 'node:child_process';
import { pathToFileURL } from 'node:url';
import { expect, test as base, type Page } from '@playwright/test';
import { without_webgl } from './page';

export const file = () => process.env.GRAZE_VIEW!;
export const url = () => pathToFileURL(file()).href;
export const doubles_url = () => pathToFileURL(process.env.GRAZE_VIEW_DOUBLES!).href;

// Without WebGL, except in tests that ask for it, because it takes most of the time if there is no GPU.
export const test = base.extend<{ webgl: boolean; of_doubles: boolean; viewer: Page }>({
  webgl: [false, { option: true }],
  of_doubles: [false, { option: true }],
  viewer: async ({ page, webgl, of_doubles }, use) => {
    if (!webgl) await page.addInitScript(without_webgl);
    test.skip(!file(), 'this build has no viewer');
    const address = of_doubles ? doubles_url() : url();
    const fetched: string[] = [],
      said: string[] = [];
    page.on('request', (request) => {
      const asked = request.url().split('#')[0];
      if (asked !== address && !asked.startsWith('data:') && !asked.startsWith('blob:')) fetched.push(asked);
    });
    page.on('console', (message) => said.push(`${message.type()}: ${message.text()}`));
    page.on('pageerror', (error) => said.push(`error: ${error.message}`));
    await page.goto(address);
    await page.waitForSelector('#replayed');
    await use(page);
    expect(fetched, 'fetched').toEqual([]);
    expect(said, 'on the console').toEqual([]);
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

// What `graze check` says about the pair that is shown.
export async function checked(page: Page) {
  await page.locator('#copies button', { hasText: 'check line' }).click();
  const line = (await page.locator('.copied code').textContent())!;
  return JSON.parse(
    execFileSync(process.env.GRAZE!, ['check', '-', '--json', '--executor', 'twin'], { input: line, encoding: 'utf8' }),
  ) as { truth: { verdict: string; contact: string }; lanes: Record<string, string>; coordinates?: string };
}

// "Copy as" gives these texts, by kind.
export async function expect_copies(page: Page, copies: Record<string, string>) {
  for (const [kind, text] of Object.entries(copies)) {
    await page.locator('#copies button').getByText(kind, { exact: true }).click();
    await expect(page.locator('.copied code')).toContainText(text);
  }
}

export { expect };
