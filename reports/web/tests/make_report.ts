// SPDX-License-Identifier: Apache-2.0
// Makes the page that the tests open: a real campaign, minimised, by the graze that GRAZE names. GRAZE_REPORT names a
// page made before instead, and GRAZE_COMPARE one that compares.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const kStrata = 'thesis,near_edge_edge,coplanar_wide,exact_contact,far_from_origin,extreme_scale';

export default function make_report() {
  const { GRAZE, GRAZE_REPORT } = process.env;
  if (GRAZE_REPORT) {
    if (!existsSync(GRAZE_REPORT)) throw new Error(`GRAZE_REPORT: expected a report's page, found nothing at ${GRAZE_REPORT}`);
    return;
  }
  if (!GRAZE) throw new Error('GRAZE: expected the path of the graze binary, found nothing');
  const folder = mkdtempSync(join(tmpdir(), 'graze-page-'));
  const run = (...args: string[]) => execFileSync(GRAZE, args, { cwd: folder, stdio: ['ignore', 'ignore', 'inherit'] });
  const fuzz = (seed: string, out: string) => run('fuzz', '--pairs', '1500', '--seed', seed, '--strata', kStrata, '--executor', 'twin', '--out', out);
  fuzz('1', 'campaign');
  run('minimize', 'campaign', '--executor', 'twin');
  run('tune', 'moller_1997/f32/cpu', '--pairs', '5000', '--strata', 'near_*', '--out', 'campaign');
  run('trade', '--pairs', '2000', '--strata', 'near_*', '--out', 'campaign');
  run('report', 'campaign');
  fuzz('2', 'other');
  run('minimize', 'other', '--executor', 'twin');
  run('report', '--compare', 'other', 'campaign');
  try {
    run('view', 'thesis:1:0', '--out', 'view.html');
    process.env.GRAZE_VIEW = join(folder, 'view.html');
  } catch {  // a build without the viewer; cli/view.test.cpp says whether it should have one
    process.env.GRAZE_VIEW = '';
  }
  process.env.GRAZE_REPORT = join(folder, 'campaign', 'report.html');
  process.env.GRAZE_COMPARE = join(folder, 'campaign', 'compare.html');
  return () => rmSync(folder, { recursive: true });
}
