// SPDX-License-Identifier: Apache-2.0
// Makes the pages under test with the graze program that GRAZE names: a minimised campaign, a smaller comparison with
// the same parts but fewer rows, a campaign with doubles, and pages of the viewer. GRAZE_REPORT and GRAZE_COMPARE name
// existing pages to use instead.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const kStrata = 'thesis,near_edge_edge,coplanar_wide,exact_contact,far_from_origin,extreme_scale';

export default function make_report() {
  const { GRAZE, GRAZE_REPORT } = process.env;
  if (GRAZE_REPORT) {
    if (!existsSync(GRAZE_REPORT)) throw new Error(`GRAZE_REPORT: there is no page at ${GRAZE_REPORT}`);
    return;
  }
  if (!GRAZE) throw new Error('set GRAZE to the path of the graze program');
  const folder = mkdtempSync(join(tmpdir(), 'graze-page-'));
  const run = (command: string) =>
    execFileSync(GRAZE, command.split(' '), { cwd: folder, stdio: ['ignore', 'ignore', 'inherit'] });
  const campaign = (out: string, of: string) => {
    run(`fuzz ${of} --strata ${kStrata} --executor twin --out ${out}`);
    run(`minimize ${out} --executor twin`);
    run(`tune moller_1997/f32/cpu --pairs 5000 --strata near_* --out ${out}`);
    run(`pareto --pairs 2000 --strata near_* --out ${out}`);
  };
  campaign('campaign', '--pairs 900 --seed 1 --lanes */f32/*,moller_1997/f64/*');
  run('report campaign');
  const lanes = '*/f32/cpu,moller_1997/f32/cuda*,interval_overlap/f32/x*';
  campaign('other', `--pairs 300 --seed 2 --lanes ${lanes} --toolchains x86-gcc,x87`);
  run('report --compare campaign other');
  const of_doubles = '--coordinates both --strata uniform,near_edge_edge,stored --lanes moller_1997/*/cpu,exact/*/cpu';
  run(`fuzz --pairs 500 ${of_doubles} --out doubles`);
  run('minimize doubles');
  run('report doubles');
  process.env.GRAZE_DOUBLES = join(folder, 'doubles', 'report.html');
  try {
    run('view thesis:1:0 --out view.html');
    process.env.GRAZE_VIEW = join(folder, 'view.html');
    const at = (x: string) => `v ${x} 0 0\nv ${x} 1 0\nv ${x} 0 1\n`;
    writeFileSync(join(folder, 'walls.obj'), `${at('1000000.01')}${at('1000000.02')}f 1 2 3\nf 4 5 6\n`);
    run('view walls.obj --out doubles.html');
    process.env.GRAZE_VIEW_DOUBLES = join(folder, 'doubles.html');
  } catch {
    // this build has no viewer; cli/view.test.cpp tests whether it should have one
    process.env.GRAZE_VIEW = '';
  }
  process.env.GRAZE_REPORT = join(folder, 'campaign', 'report.html');
  process.env.GRAZE_COMPARE = join(folder, 'other', 'compare.html');
  return () => rmSync(folder, { recursive: true });
}
