// SPDX-License-Identifier: Apache-2.0
// node tests/viewer_screens.mjs GRAZE FOLDER: screenshots of the viewer for docs/viewer.md, on desktop and phone: a
// special case of 2012, a contraction flip, an overflow, the simplest case of a mesh, and a query.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const [graze, out] = process.argv.slice(2).map((path) => resolve(path));
const folder = mkdtempSync(join(tmpdir(), 'graze-screens-')),
  here = dirname(fileURLToPath(import.meta.url));
const run = (...args) => execFileSync(graze, args, { cwd: folder, stdio: ['ignore', 'ignore', 'inherit'] });

// Hills on a grid: neighbours share edges and vertices.
const kSide = 24,
  columns = kSide + 1;
const vertices = Array.from({ length: columns ** 2 }, (_, v) => [v % columns, Math.floor(v / columns)]).map(
  ([i, j]) => `v ${i} ${j} ${(0.3 * Math.sin(i) * Math.cos(0.7 * j)).toFixed(6)}`,
);
const faces = Array.from({ length: kSide ** 2 }, (_, c) => 1 + (c % kSide) + Math.floor(c / kSide) * columns).map(
  (v) => `f ${v} ${v + 1} ${v + columns + 1}\nf ${v} ${v + columns + 1} ${v + columns}`,
);
writeFileSync(join(folder, 'hills.obj'), [...vertices, ...faces, ''].join('\n'));
writeFileSync(join(folder, 'ref.txt'), '2 3 -2  21 5 -2  11 22 3\n');
writeFileSync(
  join(folder, 'pair.txt'),
  '0.1 0.2 0.3  0.4 0.9 0.2  0.7 0.1 0.6   0.1 0.2 0.3  0.5 0.5 0.9  -0.3 0.8 0.4\n',
); // of the README

run('fuzz', '--mesh', 'hills.obj', '--executor', 'twin', '--out', 'hills');
run('minimize', 'hills', '--executor', 'twin');
for (const [name, ...what] of [
  ['special'],
  ['flip', 'pair.txt'],
  ['overflow', 'extreme_scale:1:2'],
  ['mesh', 'hills'],
  ['query', 'ref.txt', 'hills.obj'],
]) {
  run('view', ...what, '--out', `${name}.html`);
  const pictures = ['desktop', 'phone'].map((where) => join(out, `${name}-${where}.png`));
  execFileSync(process.execPath, [join(here, 'screens.mjs'), join(folder, `${name}.html`), ...pictures], {
    stdio: 'inherit',
  });
  try {
    for (const picture of pictures) execFileSync('convert', [picture, '+dither', '-colors', '64', `PNG8:${picture}`]);
  } catch {
    // without ImageMagick, the pictures are only larger
  }
}
rmSync(folder, { recursive: true });
