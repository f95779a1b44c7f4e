// SPDX-License-Identifier: Apache-2.0
// One file with everything in it: no chunk, style sheet or picture beside the page, which opens from disk. The report is
// index.html; with --mode viewer, view.html, which holds the module that GRAZE_WASM names.
import { readFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';
import { defineConfig } from 'vite';
import { viteSingleFile } from 'vite-plugin-singlefile';

const graze_wasm = {
  name: 'graze-wasm',
  enforce: 'pre',
  resolveId: (id) => (id === 'graze.wasm' ? '\0graze.wasm' : null),
  load: (id) => (id === '\0graze.wasm' ? `export default "${gzipSync(readFileSync(process.env.GRAZE_WASM), { level: 9 }).toString('base64')}"` : null),
};

export default defineConfig(({ mode }) => ({
  base: './',
  plugins: [graze_wasm, viteSingleFile({ removeViteModuleLoader: true })],
  worker: { format: 'iife' },
  build: {
    target: 'es2020', emptyOutDir: mode !== 'viewer', reportCompressedSize: false, chunkSizeWarningLimit: 4096,
    rollupOptions: { input: mode === 'viewer' ? 'view.html' : 'index.html' },
  },
}));
