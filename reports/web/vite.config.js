// SPDX-License-Identifier: Apache-2.0
// Bundles the page into one file, with all chunks, style sheets and pictures, so it can be opened from disk. The report
// is index.html; with --mode viewer, the page is view.html. GRAZE_VIEWER is set if the build has the viewer. Only then
// does the page contain source lines, which the viewer quotes. graze writes the viewer's module and data into the page.
import { readFileSync, readdirSync } from 'node:fs';
import { defineConfig } from 'vite';
import { viteSingleFile } from 'vite-plugin-singlefile';

// The source lines at which lanes take their steps, by file. Empty if there is no viewer.
function source_lines() {
  const root = process.env.GRAZE_SOURCE;
  if (!process.env.GRAZE_VIEWER) return {};
  const files = ['core/vec3.h', ...readdirSync(`${root}/core/algorithms`).map((name) => `core/algorithms/${name}`)];
  const lines = (file) => readFileSync(`${root}/${file}`, 'utf8').split('\n');
  return Object.fromEntries(
    files
      .filter((file) => !/(algorithms?|traced)\.h$/.test(file))
      .map((file) => [file, lines(file).map((line) => line.trim())]),
  );
}
const sources = {
  name: 'graze-sources',
  enforce: 'pre',
  resolveId: (id) => (id === 'graze.sources' ? '\0graze.sources' : null),
  load: (id) => (id === '\0graze.sources' ? `export default ${JSON.stringify(source_lines())}` : null),
};

export default defineConfig(({ mode }) => ({
  base: './',
  plugins: [sources, viteSingleFile({ removeViteModuleLoader: true })],
  worker: { format: 'iife' },
  build: {
    target: 'es2020',
    emptyOutDir: mode !== 'viewer',
    reportCompressedSize: false,
    chunkSizeWarningLimit: 4096,
    rollupOptions: { input: mode === 'viewer' ? 'view.html' : 'index.html' },
  },
}));
