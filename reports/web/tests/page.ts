// SPDX-License-Identifier: Apache-2.0
// The page under test, which must never fetch anything or write to the console.
import { pathToFileURL } from 'node:url';
import AxeBuilder from '@axe-core/playwright';
import { expect, test as base, type Locator, type Page } from '@playwright/test';
import type { Costs, Report } from '../src/report';

export const url = () => pathToFileURL(process.env.GRAZE_REPORT!).href;
export const compare_url = () => pathToFileURL(process.env.GRAZE_COMPARE || process.env.GRAZE_REPORT!).href;
export const doubles_url = () => pathToFileURL(process.env.GRAZE_DOUBLES || process.env.GRAZE_REPORT!).href;

// Without WebGL, except in tests that need it, because WebGL takes most of the time if there is no GPU.
export const test = base.extend<{ webgl: boolean; report: Report; costs: Costs | null; watched: void }>({
  webgl: [false, { option: true }],
  watched: [
    async ({ page, webgl }, use) => {
      if (!webgl) await page.addInitScript(without_webgl);
      const expect_quiet = watch(page, [url(), compare_url(), doubles_url()]);
      await page.goto(url());
      await page.waitForSelector('#method');
      await use();
      expect_quiet();
    },
    { auto: true },
  ],
  report: async ({ page, watched: _ }, use) => {
    await use(JSON.parse((await page.locator('#report').textContent())!) as Report);
  },
  costs: async ({ page, watched: _ }, use) => {
    await use(JSON.parse((await page.locator('#costs').textContent())!) as Costs | null);
  },
});

export { expect };

// Returns: a check that, since this call, the page has fetched only these addresses and written nothing to the console.
export function watch(page: Page, addresses: string[]) {
  const fetched: string[] = [],
    said: string[] = [];
  page.on('request', (request) => {
    const asked = request.url().split('#')[0];
    if (!addresses.includes(asked) && !/^(data|blob):/.test(asked)) fetched.push(asked);
  });
  page.on('console', (message) => said.push(`${message.type()}: ${message.text()}`));
  page.on('pageerror', (error) => said.push(`error: ${error.message}`));
  return () => {
    expect(fetched, 'fetched').toEqual([]);
    expect(said, 'on the console').toEqual([]);
  };
}

// The violations that axe finds on the page, or in a part of it.
export async function violations(page: Page, part = 'html') {
  const found = await new AxeBuilder({ page }).include(part).analyze();
  return found.violations.map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html).join(' ')}`);
}

// For addInitScript.
export function without_webgl() {
  const real = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (this: HTMLCanvasElement, kind: string, ...rest: unknown[]) {
    return kind.startsWith('webgl') ? null : (real as Function).call(this, kind, ...rest);
  } as typeof real;
}

// The painted pixels, for comparison.
export async function pixels(element: Locator): Promise<string> {
  return (await element.screenshot({ animations: 'disabled' })).toString('base64');
}

export async function open_card(page: Page, number: number): Promise<Locator> {
  const card = page.locator(`#kind-${number}`);
  if ((await card.getAttribute('open')) === null) await card.locator('summary').first().click();
  await card.locator('.board').scrollIntoViewIfNeeded();
  return card;
}
