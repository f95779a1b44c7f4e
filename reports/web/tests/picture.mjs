// SPDX-License-Identifier: Apache-2.0
// node tests/picture.mjs REPORT.html CARD OUT.png: the tour's picture of a card and the league table's cpu lanes.
import { execSync } from 'node:child_process';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { chromium } from '@playwright/test';

const [report, number, out] = process.argv.slice(2);
const executablePath = process.env.GRAZE_CHROMIUM ?? execSync('command -v chromium', { encoding: 'utf8' }).trim();
const browser = await chromium.launch({
  executablePath,
  args: ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--no-sandbox'],
});
const page = await browser.newPage({ viewport: { width: 1260, height: 1600 } });
await page.goto(pathToFileURL(resolve(report)).href);
await page.locator('#league input[type=search]').fill('/cpu');
await page.locator('#league .chips button', { hasText: /^cpu-fma$/ }).click();
await page.locator(`#kind-${number}`).evaluate((card) => (card.open = true));
await page.addStyleTag({
  content: `
  header, nav, section:not(#league, #kinds), #league > :not(.between, .sortable), #kinds > :not(#kind-${number}), .heat-legend + p { display: none }
  section { border: 0; padding: 0.5rem 0 0 } main { padding: 0 1rem 0.75rem } .between { margin-top: 0.5rem } .card { margin: 0.5rem 0 0 }
  #kind-${number} .card-body > :not(.kind-lanes, .card-top, .card-low), .stage-tools, .inline-copy { display: none }`,
});
await page.evaluate(() => scrollTo(0, 0));
await page.waitForTimeout(500);
await page.locator('main').screenshot({ path: out });
await browser.close();
