// SPDX-License-Identifier: Apache-2.0
// The viewer on pairs of doubles: two parallel triangles from a model in metres, which coincide in float32.
import {
  coordinate,
  doubles_url,
  expect,
  expect_as_checked,
  expect_copies,
  name,
  paste,
  test,
  verdict,
  verdicts,
} from './viewer_page';

test.use({ of_doubles: true });

test('the truth is that of the doubles, and float lanes decide them rounded to float32', async ({ viewer }) => {
  await expect(viewer.locator('#truth')).toHaveText(
    /^Truth: disjoint, 0\.01 \(.* ulps\) apart; as float32 stores it: intersects, contact: area$/,
  );
  await expect(viewer.locator('#replayed')).toContainText('Same as the native build');
  await expect(verdict(viewer, 'exact/f64/cpu')).toHaveText('disjoint');
  for (const [lane, said] of Object.entries(await verdicts(viewer)))
    expect(said, lane).toBe(lane.includes('/f32/') ? 'intersects' : 'disjoint');
  await verdict(viewer, 'moller_1997/f32/cpu').click();
  await expect(viewer.locator('#why')).toContainText(
    'It is wrong. It decides the coordinates as float32 stores them. For these its verdict is right, so the cause is rounding of the input.',
  );
  await verdict(viewer, 'exact/f32/cpu').click();
  await expect(viewer.locator('#why')).toContainText(
    'It decides the coordinates as float32 stores them. It is the exact decision: it computes with integers',
  );
  await verdict(viewer, 'moller_1997/f64/cpu').click();
  await expect(viewer.locator('#why')).toContainText('It is right.');
  await expect(viewer.locator('#why')).not.toContainText('float32 stores');
});

test('it agrees with graze check, including on pairs of strata', async ({ viewer }) => {
  for (const stratum of ['', 'large_offset/f64', 'exact_contact/f64']) {
    if (stratum) {
      await viewer.getByLabel('Pairs of').selectOption(stratum);
      await viewer.keyboard.press('Shift+n'); // a pair that shows more
      await expect.poll(() => name(viewer), { timeout: 30_000 }).toMatch(new RegExp(`^${stratum}:1:[1-9]`));
    }
    expect((await expect_as_checked(viewer)).coordinates).toBe('f64');
  }
});

test('doubles are typed, stepped and linked without rounding', async ({ viewer }) => {
  await expect(coordinate(viewer, 0)).toHaveValue('1000000.01');
  await coordinate(viewer, 4).fill('0.1');
  await coordinate(viewer, 4).blur();
  await expect(coordinate(viewer, 4)).toHaveValue('0.1');
  await expect(viewer.locator('#exactly')).toHaveText(
    'a[1].y is exactly 0x1.999999999999ap-4; an ulp of it is 1.3877787807814457e-17',
  );
  await viewer.locator('button', { hasText: '+ 1 ulp' }).click();
  await expect(coordinate(viewer, 4)).toHaveValue('0.10000000000000002');
  await coordinate(viewer, 5).fill('1e309');
  await coordinate(viewer, 5).blur();
  await expect(viewer.locator('.message')).toHaveText("expected a number of double for a[1].z, found '1e309'");
  await viewer.locator('#copies button', { hasText: 'link' }).click();
  const link = (await viewer.locator('.copied code').textContent())!;
  expect(link).toMatch(/#p=[0-9a-f]{288}&/);
  await expect.poll(() => viewer.url()).toBe(link);
  await viewer.goto('about:blank');
  await viewer.goto(link);
  await expect(coordinate(viewer, 4)).toHaveValue('0.10000000000000002');
  // A link with a float32 pair shows the same pair as doubles.
  await viewer.goto('about:blank');
  await viewer.goto(`${doubles_url()}#p=${'3dcccccd'.repeat(18)}`);
  await expect(coordinate(viewer, 4)).toHaveValue('0.10000000149011612');
  await expect_copies(viewer, {
    C: 'const double a[3][3] = {{0x1.99999ap-4, ',
    CUDA: '__constant__ double3',
    Python: 'float.fromhex("0x1.99999ap-4")',
    OBJ: 'v 0.10000000149011612 ',
  });
});

test('maps, tolerances, many triangles and the drawing work on doubles', async ({ viewer }) => {
  await expect(viewer.locator('#board svg polygon.triangle-b')).toHaveCount(1);
  await viewer.locator('#map').scrollIntoViewIfNeeded();
  await expect(viewer.locator('#map-told')).toContainText(/^256 × 256 cells of \d lanes and the truth/, {
    timeout: 60_000,
  });
  await viewer.getByLabel('Treated as zero').selectOption('filtered');
  await expect(viewer.locator('#summary')).toContainText('under filtered');
  await expect(verdict(viewer, 'guigue_devillers_2003/f64/cpu')).toHaveText('disjoint');
  await viewer.locator('body').press('+');
  await expect(viewer.locator('#field')).toContainText('2 triangles against a, the reference');
  await viewer.locator('body').press('t'); // the special cases of 2012
  await expect(viewer.locator('h1')).toHaveText('the ten special cases of 2012');
});

test('coordinates at the ends of the range are shown', async ({ viewer }) => {
  for (const scale of ['1e308', '5e-324']) {
    await paste(viewer, `0 0 0  ${scale} 0 0  0 ${scale} 0  0 0 ${scale}  ${scale} 0 ${scale}  0 ${scale} ${scale}`);
    await expect(coordinate(viewer, 3)).toHaveValue(String(Number(scale)));
    expect((await expect_as_checked(viewer)).truth.verdict).toBe('disjoint');
    await expect(viewer.locator('#board svg polygon.triangle-b')).toHaveCount(1);
  }
});
