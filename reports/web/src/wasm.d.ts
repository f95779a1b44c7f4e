// SPDX-License-Identifier: Apache-2.0
// graze.wasm as vite.config.js provides it: compressed with gzip, in base64.
declare module 'graze.wasm' {
  const base64: string;
  export default base64;
}

// The lines of the source files in which lanes take their steps, by file, such as "core/vec3.h".
declare module 'graze.sources' {
  const lines: Record<string, string[]>;
  export default lines;
}
