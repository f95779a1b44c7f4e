// SPDX-License-Identifier: Apache-2.0
// Settings of the page's tests. They use the system's Chromium (GRAZE_CHROMIUM, or chromium on the PATH) and do not
// download one.
import { execSync } from 'node:child_process';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { defineConfig } from '@playwright/test';

const chromium = process.env.GRAZE_CHROMIUM ?? execSync('command -v chromium', { encoding: 'utf8' }).trim();

// Chromium runs without its sandbox, which does not work for root in a container.
const launched = (...args) => ({ executablePath: chromium, args: ['--no-sandbox', ...args] });

export default defineConfig({
  testDir: 'tests',
  outputDir: process.env.GRAZE_TEST_OUTPUT ?? join(tmpdir(), 'graze-page-test-results'),
  globalSetup: './tests/make_report.ts',
  workers: 1,
  // The limit is long, because a busy machine is slow.
  timeout: 300_000,
  expect: { timeout: 60_000 },
  reporter: 'list',
  // An emulated GPU takes most of the processor time, so only the WebGL tests use one.
  projects: [
    { name: 'plain', grepInvert: /by WebGL/, use: { launchOptions: launched('--disable-gpu') } },
    {
      name: 'webgl',
      grep: /by WebGL/,
      use: { launchOptions: launched('--use-angle=swiftshader', '--enable-unsafe-swiftshader') },
    },
  ],
  use: {
    // The window is low because painting takes most of the processor time: parts outside it are not painted, and their
    // maps are not computed.
    viewport: { width: 1360, height: 480 },
    contextOptions: { permissions: ['clipboard-read', 'clipboard-write'] },
  },
});
