// SPDX-License-Identifier: Apache-2.0
// The lines of the source files in which lanes take their steps, by file name, such as "core/vec3.h".
declare module 'graze.sources' {
  const lines: Record<string, string[]>;
  export default lines;
}
