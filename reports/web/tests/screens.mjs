// SPDX-License-Identifier: Apache-2.0
// node tests/screens.mjs PAGE.html DESKTOP.png PHONE.png: screenshots of the top of a report or a viewer, for the
// documents.
import { execSync } from 'node:child_process';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { chromium } from '@playwright/test';

const [report, desktop, phone] = process.argv.slice(2);
const executablePath = process.env.GRAZE_CHROMIUM ?? execSync('command -v chromium', { encoding: 'utf8' }).trim();
const browser = await chromium.launch({
  executablePath,
  args: ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--no-sandbox'],
});
for (const [path, width, height] of [
  [desktop, 1280, 800],
  [phone, 390, 844],
]) {
  const page = await browser.newPage({ viewport: { width, height } });
  await page.goto(pathToFileURL(resolve(report)).href);
  await page.waitForSelector('#glance svg, #replayed');
  await page.waitForTimeout(1500); // the viewer's result takes a moment
  await page.screenshot({ path });
}
await browser.close();
