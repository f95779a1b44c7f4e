// SPDX-License-Identifier: Apache-2.0
// The page of `graze view` must not fetch anything or write to the console, and must agree with the native build.
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { pathToFileURL } from 'node:url';
import type { Page } from '@playwright/test';
import { pixels, violations, without_webgl } from './page';
import {
  coordinate,
  expect,
  expect_as_checked,
  expect_copies,
  file,
  name,
  paste,
  test,
  to_another_pair,
  url,
  verdict,
  verdicts,
} from './viewer_page';

const kCells = 256;
const kEndsApart =
  '40000000c0000000408000003f80000040a00000c00000003f800000c0400000c04000003ff333344019999a40d66666bdccccc0bf19999a409666663ff33334bf19999a402ccccd'; // thesis:1:15524
const kOverflow =
  'd01cb3ffcf1130a24fd0e03dd0111e894fc5fbfb4fb67a05cee82f564ea92d6bce58537dceb4244ccf02f27ccf8846bbcf581c374eb351f54dda496bcec4d16a4f5f9694ce41af95'; // extreme_scale:1:2

// Opens the address as a new page, because changing only the hash would race with the page's own changes to the hash.
async function open_afresh(page: Page, address: string) {
  await page.goto('about:blank');
  await page.goto(address);
}

test('it checks itself against stored verdicts, and shows on how many pairs', async ({ viewer }) => {
  const said = (await viewer.locator('#replayed').textContent())!;
  const [, pairs, lanes] = /^Same as the native build on (\d+) pairs, (\d+) lanes each\.$/.exec(said)!.map(Number);
  expect(pairs).toBeGreaterThan(300);
  expect(await viewer.locator('[data-lane]').count()).toBe(lanes);
});

test('it shows no verdicts if one differs from the stored one', async ({ page }) => {
  test.skip(!file());
  const altered = join(dirname(file()), 'altered.html'),
    text = readFileSync(file(), 'utf8'),
    stored = /"verdicts":"([012])/;
  writeFileSync(
    altered,
    text.replace(stored, (_, first) => `"verdicts":"${first === '1' ? 0 : 1}`),
  );
  await page.goto(pathToFileURL(altered).href);
  await expect(page.locator('#warning')).toContainText(
    /decides differently from the native build: stored pair 1, projected_sat\/f32\/cpu: here \w+, natively \w+\./,
  );
  await expect(page.locator('[data-lane]')).toHaveCount(0);
});

test('it works in a notebook’s frame, which has no address', async ({ page }) => {
  test.skip(!file());
  await page.addInitScript(without_webgl);
  await page.setContent('<iframe style="width: 100%; height: 560px"></iframe>');
  const text = readFileSync(file(), 'utf8');
  await page.locator('iframe').evaluate((frame, text) => ((frame as HTMLIFrameElement).srcdoc = text), text);
  const inside = page.frameLocator('iframe');
  await expect(inside.locator('#replayed')).toContainText('Same as the native build');
  await expect(inside.locator('[data-lane]').first()).toBeVisible();
});

test('it agrees with graze check', async ({ viewer }) => {
  for (let pair = 0; pair < 3; ++pair) {
    const { truth } = await expect_as_checked(viewer);
    if (truth.contact !== 'none') await expect(viewer.locator('#truth')).toContainText(`contact: ${truth.contact}`);
    await to_another_pair(viewer, () => viewer.keyboard.press('Shift+n')); // a pair that shows more
  }
});

test('for a pair on which CPU and GPU differ, it shows which lane, and why', async ({ viewer }) => {
  await open_afresh(
    viewer,
    `${url()}#p=3dcccccd3e4ccccd3e99999a3ecccccd3f6666663e4ccccd3f3333333dcccccd3f19999a3dcccccd3e4ccccd3e99999a3f0000003f0000003f666666be99999a3f4ccccd3ecccccd`,
  );
  await expect(viewer.locator('#summary')).toContainText('CPU and GPU differ: guigue_devillers_2003/f64.');
  await expect(verdict(viewer, 'guigue_devillers_2003/f64/cuda-fma')).toHaveAttribute('aria-pressed', 'true');
  await expect(verdict(viewer, 'guigue_devillers_2003/f64/cuda-fma')).toHaveAttribute(
    'aria-label',
    'guigue_devillers_2003/f64/cuda-fma: disjoint, wrong, differs from the CPU',
  );
  await expect(viewer.locator('#summary')).toContainText('4 of 32 lanes are wrong, 1 of them only on the GPU.');
  await expect(viewer.locator('#brief')).toHaveText(
    'guigue_devillers_2003 in f64 asks: on the CPU -0 > 0, no; on the GPU 2.61·10⁻¹⁹ > 0, yes. Why?',
  );
  await expect(viewer.locator('tr.apart')).toHaveText(/^guigue_devillers_2003\/f64/);
  const why = viewer.locator('#why');
  await expect(viewer.locator('#why-title')).toHaveText('Why do CPU and GPU differ?');
  for (const said of [
    'guigue_devillers_2003 in float64 says intersects on the CPU (right) and disjoint on the GPU (wrong). The cause is contraction: for the GPU nvcc fuses',
    'into one operation that rounds once; the CPU rounds twice',
    'Built with -fmad=false, the GPU says intersects.',
    'Both run the same source on the same numbers. The first comparison with a different outcome is at core/algorithms/guigue_devillers_2003.h:121',
    'if (db[0] * db[1] > zero && db[0] * db[2] > zero) return Verdict::disjoint;',
    'more than 0 if both vertices lie on the same side of the plane. The distances are 0 and -0.235 on the CPU, and -1.11·10⁻¹⁸ and -0.235 on the GPU. With 113 bits the value is 0: any other value there is a rounding error, and its sign decides.',
    'Fusing only here already gives the GPU’s verdict: core/vec3.h:48',
    'called at core/algorithms/guigue_devillers_2003.h:120',
  ])
    await expect(why).toContainText(said);
  expect(await viewer.locator('.parting tr').allInnerTexts()).toEqual([
    expect.stringMatching(/value\s+> 0\?\s+result/),
    expect.stringMatching(/^CPU\s+-0\s+no\s+continues, then says intersects$/),
    expect.stringMatching(/^GPU\s+2\.61·10⁻¹⁹\s+yes\s+continues, then says ✗ disjoint$/),
    expect.stringMatching(/^with 113 bits\s+0\s+no\s+as the CPU$/),
  ]);
  await verdict(viewer, 'guigue_devillers_2003/f64/cpu').click(); // the CPU lane leads to the same question
  await expect(viewer.locator('#why-title')).toHaveText('Why do CPU and GPU differ?');
  await verdict(viewer, 'guigue_devillers_2003/f32/cpu').click();
  await expect(viewer.locator('#why-title')).toHaveText('Why does guigue_devillers_2003/f32/cpu say disjoint?');
});

test('its explanations of contractions agree with graze explain', async ({ viewer }) => {
  test.slow();
  await viewer.getByLabel('Pairs of').selectOption('near_edge_edge');
  let compared = 0;
  for (let pair = 0; pair < 4; ++pair) {
    await to_another_pair(viewer, () => viewer.locator('button', { hasText: 'Next where CPU and GPU differ' }).click());
    const chosen = (await viewer.locator('[data-lane][aria-pressed="true"]').getAttribute('data-lane'))!;
    const [subject, , variant] = chosen.split('/'),
      says = (await verdicts(viewer))[chosen];
    expect(variant).toBe('cuda-fma');
    await expect(viewer.locator('.because')).toContainText(
      new RegExp(`^${subject} in float(32|64) says \\w+ on the CPU \\((right|wrong)\\) and ${says} on the GPU`),
    );
    const pair_name = (await name(viewer))!;
    const explained = (lanes: string) =>
      JSON.parse(
        execFileSync(process.env.GRAZE!, ['explain', pair_name, '--lanes', lanes, '--json'], { encoding: 'utf8' }),
      ).lanes as { lane: string; cause: string; contractions: { at: string }[] }[];
    // The page blames the logic of a CPU lane if and only if the lane is wrong because of its logic.
    for (const { lane: wrong, cause } of explained('*/cpu').slice(0, 4)) {
      await verdict(viewer, wrong).click();
      await expect(viewer.locator('#why-title')).toContainText(/^Why do(es)? /);
      if (/Why do CPU/.test((await viewer.locator('#why-title').textContent())!)) continue;
      await expect(viewer.locator('#why-title')).toContainText(wrong);
      expect(
        /its logic is wrong here/.test((await viewer.locator('.because').textContent())!),
        `${wrong}: ${cause}`,
      ).toBe(cause === 'logic');
    }
    await verdict(viewer, chosen).click();
    await expect(viewer.locator('#why-title')).toContainText('Why do CPU and GPU differ?');
    const lane = explained(chosen).find((one) => one.lane === chosen);
    if (!lane) continue; // this lane is right on the GPU and wrong on the CPU
    expect(lane.cause, chosen).toBe('contraction');
    const said = viewer.locator('.because');
    await expect(said).toContainText('contraction');
    for (const { at } of lane.contractions.slice(0, 2)) await expect(said).toContainText(at);
    ++compared;
  }
  expect(compared).toBeGreaterThan(0);
});

test('it shows the ranges on a line by which the lane decides, and the margin’s axis', async ({ viewer }) => {
  const seen: Record<string, number> = {};
  for (let pair = 0; pair < 2; ++pair) {
    await to_another_pair(viewer, () => viewer.keyboard.press('Shift+n'));
    const said = await viewer.evaluate(async () => {
      const all: { lane: string; verdict: string; text: string }[] = [];
      for (const cell of document.querySelectorAll<HTMLElement>('[data-lane]')) {
        const lane = cell.dataset.lane!;
        if (/nofma|guigue|exact/.test(lane)) continue;
        cell.click();
        await new Promise((done) => setTimeout(done, 100));
        all.push({
          lane,
          verdict: cell.textContent!.replace(/[^a-z]/g, ''),
          text: document.querySelector('#ranges .compared')?.textContent ?? '',
        });
      }
      return all;
    });
    for (const { lane, verdict, text } of said) {
      const subject = lane.split('/')[0];
      if (!text) continue; // the lane decided before it computed ranges, or it compares none
      expect(text).toContain(`In ${lane} the two ranges `);
      expect(/^In \S+ the two ranges are \S+ apart;/.test(text), `${lane} says ${verdict}: ${text}`).toBe(
        verdict === 'disjoint',
      );
      seen[subject] = (seen[subject] ?? 0) + 1;
    }
    const [, margin] =
      /(?:disjoint|intersects), (?:contact: \w+, )?([\d.]+(?:·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?) \(/.exec(
        (await viewer.locator('#truth').textContent())!,
      ) ?? [];
    if (margin)
      await expect(viewer.locator('#ranges')).toContainText(
        new RegExp(`(ends|by) ${margin}( before b begins)?; that is the margin`),
      );
  }
  await open_afresh(viewer, `${url()}#p=${kEndsApart}&lane=moller_1997/f32/cuda-fma`);
  await expect(viewer.locator('#brief')).toContainText(
    'asks whether a ends before b begins: on the CPU 40106304 < 40106308, yes; on the GPU 40106292 < 40106292, no.',
  );
  await expect(viewer.locator('#why')).toContainText('Neighbouring numbers of float32 are 4 apart at this size.');
  await expect(viewer.locator('#ranges svg').first().locator('text')).toHaveText([
    /^in moller_1997\/f32\/cpu$/,
    /^in moller_1997\/f32\/cuda-fma$/,
    /^with 113 bits$/,
    /, × /,
    /, × /,
    /, × /,
  ]);
  await viewer.locator('button', { hasText: 'Show the gap' }).click();
  await expect(viewer.locator('.scale-note')).toContainText('× 3.91·10⁷');
  await open_afresh(viewer, `${url()}#p=${kOverflow}&lane=interval_overlap/f32/cpu`);
  await expect(viewer.locator('#ranges')).toContainText(
    'In interval_overlap/f32/cpu the two ranges are not numbers; with 113 bits they overlap by',
  );
  expect(Object.keys(seen).sort()).toEqual(['interval_overlap', 'moller_1997', 'projected_sat', 'separating_axes']);
  expect(await viewer.locator('#ranges svg rect').count()).toBeGreaterThan(3);
});

test('a query is shown with all triangles, its hits and a lane’s errors', async ({ page }) => {
  test.skip(!file(), 'this build has no viewer');
  const folder = dirname(file()),
    kSide = 24,
    at = (i: number, j: number) => [i, j, Math.fround(0.3 * Math.sin(i) * Math.cos(0.7 * j))];
  const vertices = Array.from(
    { length: (kSide + 1) ** 2 },
    (_, v) => `v ${at(v % (kSide + 1), Math.floor(v / (kSide + 1))).join(' ')}`,
  );
  const faces = Array.from({ length: kSide ** 2 }, (_, c) => 1 + (c % kSide) + Math.floor(c / kSide) * (kSide + 1)).map(
    (v) => `f ${v} ${v + 1} ${v + kSide + 2}\nf ${v} ${v + kSide + 2} ${v + kSide + 1}`,
  );
  writeFileSync(join(folder, 'hills.obj'), [...vertices, ...faces, ''].join('\n'));
  writeFileSync(join(folder, 'ref.txt'), '2 3 -2  21 5 -2  11 22 3\n');
  const graze = (...args: string[]) => execFileSync(process.env.GRAZE!, args, { cwd: folder, encoding: 'utf8' });
  graze('view', 'ref.txt', 'hills.obj', '--out', 'query.html');
  await page.addInitScript(without_webgl);
  await page.goto(pathToFileURL(join(folder, 'query.html')).href);
  const hits = (lane: string) =>
      (
        JSON.parse(graze('query', 'ref.txt', 'hills.obj', '--executor', 'one-core', '--lanes', lane, '--json')) as {
          hits: number;
        }
      ).hits,
    exact = hits('exact');
  expect(exact).toBeGreaterThan(10);
  await expect(page.locator('#field')).toContainText(
    `1,152 triangles against a, the reference: exact/f32/cpu hits ${exact}, wrong on 0 (outlined)`,
  );
  await expect(page.locator('#board svg polygon[style*="--series-0"]')).toHaveCount(exact);
  await verdict(page, 'projected_sat/f32/cpu').click(); // wrong by logic
  await expect(page.locator('#field')).toContainText(
    `projected_sat/f32/cpu hits ${hits('projected_sat/f32/cpu').toLocaleString('en-US')}, wrong on `,
  );
  const wrong = Number(/wrong on ([\d,]+)/.exec((await page.locator('#field').textContent())!)![1].replace(',', ''));
  expect(wrong).toBe(hits('projected_sat/f32/cpu') - exact); // its only errors are false positives
  await expect(page.locator('#board svg polyline[style*="--bad"]')).toHaveCount(Math.min(wrong, 500));
  await page.locator('button', { hasText: 'Take a wrong one' }).click();
  await expect(page.locator('#why')).toContainText('logic');
});

test.describe('by WebGL', () => {
  test.use({ webgl: true });
  test('dragging a vertex updates verdicts, announces changes, and is undone in one step', async ({ viewer }) => {
    await viewer.setViewportSize({ width: 700, height: 450 }); // fewer places to try below
    await viewer.keyboard.press('t');
    await viewer.locator('button', { hasText: 'Take a hit' }).click();
    await expect(coordinate(viewer, 9)).toHaveValue('-2');
    const board = viewer.locator('#board');
    await board.scrollIntoViewIfNeeded();
    const box = (await board.boundingBox())!;
    // Finds a vertex by trying where the pointer grabs one.
    let held = false;
    for (let x = 20; x < box.width - 20 && !held; x += 20) {
      for (let y = 20; y < box.height - 20 && !held; y += 20) {
        await viewer.mouse.move(box.x + x, box.y + y);
        held = (await board.getAttribute('data-over')) === 'b[0]';
      }
    }
    expect(held).toBe(true);
    await viewer.mouse.down();
    await viewer.mouse.move(box.x + box.width - 5, box.y + 5, { steps: 5 });
    await viewer.mouse.up();
    await expect.poll(() => coordinate(viewer, 9).inputValue()).not.toBe('-2');
    expect(await name(viewer)).toContain(', changed');
    await viewer.keyboard.press('u');
    await expect(coordinate(viewer, 9)).toHaveValue('-2');
    expect(await name(viewer)).not.toContain('changed');
    await expect(board).not.toHaveClass(/flat/);
    expect((await pixels(board.locator('canvas'))).length).toBeGreaterThan(2000); // something is drawn
  });
});

test('a changed verdict is announced', async ({ viewer }) => {
  await viewer.keyboard.press('t');
  await coordinate(viewer, 9).fill('100');
  await coordinate(viewer, 12).fill('101');
  await coordinate(viewer, 15).fill('102');
  await coordinate(viewer, 15).blur();
  await expect(viewer.locator('#flips')).toContainText(/moller_1997|projected_sat/);
  await expect(viewer.locator('#flips')).toContainText('now says disjoint');
  await expect(viewer.locator('#flips')).toHaveAttribute('aria-live', 'polite');
});

test('coordinates can be typed and pasted, errors are shown, and the link has the pair', async ({ viewer }) => {
  await coordinate(viewer, 4).fill('0x1.8p+1');
  await coordinate(viewer, 4).blur();
  await expect(coordinate(viewer, 4)).toHaveValue('3');
  await coordinate(viewer, 4).fill('three');
  await coordinate(viewer, 4).blur();
  await expect(viewer.locator('.message')).toHaveText("expected a number of float32 for a[1].y, found 'three'");
  await paste(viewer, '1 2 3');
  await expect(viewer.locator('.message')).toHaveText('expected the 18 coordinates of a pair, found 3 numbers');
  await paste(viewer, `[${Array.from({ length: 18 }, (_, i) => i + 0.5).join(', ')}]`);
  await expect(coordinate(viewer, 17)).toHaveValue('17.5');
  await viewer.locator('#copies button', { hasText: 'link' }).click();
  const link = (await viewer.locator('.copied code').textContent())!;
  await expect.poll(() => viewer.url()).toBe(link);
  await viewer.keyboard.press('t');
  await expect.poll(() => viewer.url()).not.toBe(link);
  await viewer.goto(link);
  await expect(coordinate(viewer, 17)).toHaveValue('17.5');
  await expect_copies(viewer, {
    C: 'const float a[3][3]',
    CUDA: '__constant__ float3',
    Python: 'float.fromhex',
    OBJ: 'f 4 5 6',
  });
});

test('the ulp map is drawn completely, and a cell loads its pair', async ({ viewer }) => {
  const told = viewer.locator('#map-told');
  await viewer.locator('#map').scrollIntoViewIfNeeded();
  await expect(told).toContainText(/^256 × 256 cells of \d lanes and the truth, decided in \d+ ms$/, {
    timeout: 20_000,
  });
  const lane = viewer.locator('#map canvas').last();
  expect(
    await lane.evaluate((canvas: HTMLCanvasElement) =>
      canvas
        .getContext('2d')!
        .getImageData(0, 0, canvas.width, canvas.height)
        .data.every((value, i) => i % 4 < 3 || value === 255),
    ),
  ).toBe(true);
  const chosen = viewer.locator('.pair input.chosen'),
    before = await chosen.inputValue(),
    box = (await lane.boundingBox())!;
  await lane.click({ position: { x: box.width / 4, y: box.height / 2 } });
  await expect.poll(() => chosen.inputValue()).not.toBe(before);
  expect(kCells).toBe(await lane.evaluate((canvas: HTMLCanvasElement) => canvas.width));
});

test('policies apply: with filtered, only errors in logic remain', async ({ viewer }) => {
  await viewer.locator('button', { hasText: 'Next with a wrong verdict' }).click();
  await expect(viewer.locator('#summary')).toContainText('wrong', { timeout: 30_000 });
  await viewer.getByLabel('Treated as zero').selectOption('filtered');
  await expect(viewer.locator('#summary')).toContainText('under filtered');
  await expect(verdict(viewer, 'guigue_devillers_2003/f32/cpu')).not.toHaveClass(/bad/);
  await expect(verdict(viewer, 'moller_1997/f32/cuda-fma')).toHaveText('–');
  await viewer.getByLabel('Treated as zero').selectOption('abs');
  await expect(viewer.locator('#summary')).toContainText('under abs:');
});

test('without WebGL, it draws an SVG, fits on a phone, and axe finds nothing', async ({ viewer: page }) => {
  await page.setViewportSize({ width: 390, height: 844 });
  await page.emulateMedia({ colorScheme: 'dark', reducedMotion: 'reduce' });
  await page.reload();
  await expect(page.locator('#board svg polygon.triangle-b')).toHaveCount(1);
  expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBe(390);
  expect(await violations(page)).toEqual([]);
});
