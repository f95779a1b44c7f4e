// SPDX-License-Identifier: Apache-2.0
// The tests' own settings. Chromium is the system's: GRAZE_CHROMIUM, or chromium on the PATH; none is downloaded.
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
  // A busy machine is slow, not wrong.
  timeout: 180_000,
  expect: { timeout: 30_000 },
  reporter: 'list',
  use: {
    // Low: what is out of view is neither painted, which takes a processor the most here, nor are its maps decided.
    viewport: { width: 1360, height: 480 },
    launchOptions: {
      executablePath: chromium,
      // WebGL by software, where there is no GPU; no sandbox, which the root of a container cannot have.
      args: ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--no-sandbox'],
    },
    contextOptions: { permissions: ['clipboard-read', 'clipboard-write'] },
  },
});
