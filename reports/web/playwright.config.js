// SPDX-License-Identifier: Apache-2.0
// Settings of the page's tests. They use the system's Chromium (GRAZE_CHROMIUM, or chromium on the PATH), and download
// none.
import { execSync } from 'node:child_process';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { defineConfig } from '@playwright/test';

const chromium = process.env.GRAZE_CHROMIUM ?? execSync('command -v chromium', { encoding: 'utf8' }).trim();

export default defineConfig({
  testDir: 'tests',
  outputDir: process.env.GRAZE_TEST_OUTPUT ?? join(tmpdir(), 'graze-page-test-results'),
  globalSetup: './tests/make_report.ts',
  workers: 1,
  // The limit is long, because a busy machine is slow.
  timeout: 300_000,
  expect: { timeout: 60_000 },
  reporter: 'list',
  use: {
    // A low window: parts out of view need no painting, which costs most processor time here, and their maps are not
    // computed.
    viewport: { width: 1360, height: 480 },
    launchOptions: {
      executablePath: chromium,
      // WebGL in software if there is no GPU; no sandbox, because root in a container cannot have one.
      args: ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--no-sandbox'],
    },
    contextOptions: { permissions: ['clipboard-read', 'clipboard-write'] },
  },
});
