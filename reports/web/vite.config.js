// SPDX-License-Identifier: Apache-2.0
// One file with everything in it: no chunk, style sheet or picture beside index.html, which opens from disk.
import { defineConfig } from 'vite';
import { viteSingleFile } from 'vite-plugin-singlefile';

export default defineConfig({
  base: './',
  plugins: [viteSingleFile({ removeViteModuleLoader: true })],
  build: { target: 'es2020', emptyOutDir: true, reportCompressedSize: false, chunkSizeWarningLimit: 1024 },
});
