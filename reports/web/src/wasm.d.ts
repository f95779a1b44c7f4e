// SPDX-License-Identifier: Apache-2.0
// graze.wasm as vite.config.js has it: compressed by gzip, in base64.
declare module 'graze.wasm' {
  const base64: string;
  export default base64;
}

// Of the files in which lanes take their steps, their lines: "core/vec3.h".
declare module 'graze.sources' {
  const lines: Record<string, string[]>;
  export default lines;
}
