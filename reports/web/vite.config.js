// SPDX-License-Identifier: Apache-2.0
// Makes one file that contains everything, with no chunk, style sheet or picture beside it, so that the page opens from
// disk. The report is index.html; with --mode viewer, view.html. Both include the module that GRAZE_WASM names; without
// it the report's cards cannot open the viewer.
import { readFileSync, readdirSync } from 'node:fs';
import { gzipSync } from 'node:zlib';
import { defineConfig } from 'vite';
import { viteSingleFile } from 'vite-plugin-singlefile';

const graze_wasm = {
  name: 'graze-wasm',
  enforce: 'pre',
  resolveId: (id) => (id === 'graze.wasm' ? '\0graze.wasm' : null),
  load: (id) =>
    id === '\0graze.wasm'
      ? `export default "${process.env.GRAZE_WASM ? gzipSync(readFileSync(process.env.GRAZE_WASM), { level: 9 }).toString('base64') : ''}"`
      : null,
};

// The source lines at which lanes take their steps.
const kSources = [
  'core/vec3.h',
  ...(process.env.GRAZE_WASM
    ? readdirSync(`${process.env.GRAZE_SOURCE}/core/algorithms`).map((name) => `core/algorithms/${name}`)
    : []),
];
const sources = {
  name: 'graze-sources',
  enforce: 'pre',
  resolveId: (id) => (id === 'graze.sources' ? '\0graze.sources' : null),
  load: (id) =>
    id === '\0graze.sources'
      ? `export default ${JSON.stringify(
          process.env.GRAZE_WASM
            ? Object.fromEntries(
                kSources
                  .filter((file) => !/(algorithms?|traced)\.h$/.test(file))
                  .map((file) => [
                    file,
                    readFileSync(`${process.env.GRAZE_SOURCE}/${file}`, 'utf8')
                      .split('\n')
                      .map((line) => line.trim()),
                  ]),
              )
            : {},
        )}`
      : null,
};

export default defineConfig(({ mode }) => ({
  base: './',
  plugins: [graze_wasm, sources, viteSingleFile({ removeViteModuleLoader: true })],
  worker: { format: 'iife' },
  build: {
    target: 'es2020',
    emptyOutDir: mode !== 'viewer',
    reportCompressedSize: false,
    chunkSizeWarningLimit: 4096,
    rollupOptions: { input: mode === 'viewer' ? 'view.html' : 'index.html' },
  },
}));
