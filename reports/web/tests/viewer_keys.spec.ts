// SPDX-License-Identifier: Apache-2.0
// The keys of the viewer, including those of 2012.
import { execFileSync } from 'node:child_process';
import { dirname, join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { without_webgl } from './page';
import { coordinate, expect, file, name, test } from './viewer_page';

test('every key does what the help describes', async ({ viewer }) => {
  test.slow();
  const board = viewer.locator('#board');
  await board.focus();
  const looks = () => board.locator('svg').innerHTML();
  const value = (c: number) => coordinate(viewer, c).inputValue();
  // Waits until earlier changes are drawn. Otherwise two keys that undo each other would seem to do nothing.
  const drawn = () =>
    viewer.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  const changes = (of: () => Promise<unknown>) => async (key: string) => {
    await drawn();
    const before = await of();
    await viewer.keyboard.press(key);
    await expect.poll(of, { message: key }).not.toEqual(before);
  };
  const moves = (c: number, by: number) => async (key: string) => {
    const before = Number(await value(c));
    await viewer.keyboard.press(key);
    await expect.poll(async () => Number(await value(c)), { message: key }).toBe(before + by);
  };
  const chosen = (c: number) => async (key: string) => {
    await viewer.keyboard.press(key);
    await expect(coordinate(viewer, c), key).toHaveClass(/chosen/);
  };
  const shown = (what: string) => changes(() => viewer.locator(`[data-shows="${what}"]`).getAttribute('aria-pressed'));
  const names = () => name(viewer),
    field = async () => (await viewer.locator('#field').textContent())!;
  const expected: [string, (key: string) => Promise<void>][] = [
    ['t', changes(names)],
    ['←', changes(looks)],
    ['→', changes(looks)],
    ['↑', changes(looks)],
    ['↓', changes(looks)],
    ['w', moves(0, -0.0625)],
    ['s', moves(3, 0.0625)],
    ['a', moves(1, -0.0625)],
    ['d', moves(4, 0.0625)],
    ['q', moves(2, -0.0625)],
    ['e', moves(8, 0.0625)],
    ['o', shown('axes')],
    ['c', shown('coordinates')],
    ['i', shown('ids')],
    ['p', shown('planes')],
    ['g', changes(() => viewer.locator('[data-lane][aria-pressed="true"]').getAttribute('data-lane'))],
    [
      '+',
      async (key) => {
        await viewer.keyboard.press('t'); // leave the special cases, because their number is fixed
        await changes(field)(key);
      },
    ],
    ['-', changes(field)],
    ['space', changes(field)],
    ['n', changes(names)],
    ['b', changes(names)],
    ...['0', '1', '2', '3', '4', '5'].map((key, v) => [key, chosen(3 * v)] as [string, (key: string) => Promise<void>]),
    ['y', chosen(16)],
    ['z', chosen(17)],
    ['x', chosen(15)],
    ['[', changes(() => value(15))],
    [']', changes(() => value(15))],
    ['f', changes(() => viewer.getByLabel('Centre').inputValue())],
    ['Home', changes(() => viewer.getByLabel('Centre').inputValue())],
    ['u', changes(() => value(15))],
    ['r', changes(() => value(15))],
    ['Control+z', changes(() => value(15))],
    ['Control+y', changes(() => value(15))],
    [
      'h',
      async (key) => {
        await viewer.keyboard.press(key);
        await expect(viewer.locator('#help')).toBeVisible();
        await expect(viewer.locator('#help-title')).toBeFocused();
        await viewer.keyboard.press(key);
        await expect(viewer.locator('#help')).toBeHidden();
      },
    ],
  ];
  const kNames: Record<string, string> = {
    '←': 'ArrowLeft',
    '→': 'ArrowRight',
    '↑': 'ArrowUp',
    '↓': 'ArrowDown',
    space: ' ',
  };
  for (const [key, check] of expected) await check(kNames[key] ?? key);
  const listed = await viewer.locator('#help kbd').allTextContents();
  expect(
    expected
      .map(([key]) => key)
      .filter((key) => !key.startsWith('Control'))
      .sort(),
  ).toEqual(listed.sort());
});

test('steps are of one ulp, of 256 with Shift, of 65,536 with Alt', async ({ viewer }) => {
  await coordinate(viewer, 0).fill('1');
  await coordinate(viewer, 0).blur();
  for (const [key, expected] of [
    [']', 1 + 2 ** -23],
    ['[', 1],
    ['Shift+BracketRight', 1 + 2 ** -15],
    ['Shift+BracketLeft', 1],
    ['Alt+BracketRight', 1 + 2 ** -7],
    ['Alt+BracketLeft', 1],
  ] as const) {
    await viewer.keyboard.press(key);
    await expect
      .poll(async () => Math.fround(Number(await coordinate(viewer, 0).inputValue())))
      .toBe(Math.fround(expected));
  }
});

test('t shows all special cases of 2012, which are fixed', async ({ viewer }) => {
  const before = await name(viewer);
  await viewer.keyboard.press('t');
  await expect(viewer.locator('h1')).toHaveText('the ten special cases of 2012');
  await expect(viewer.locator('#field')).toContainText('10 triangles against a, the reference');
  await expect(viewer.locator('#board svg polygon[style*="--series-0"]')).toHaveCount(10); // all are meant to intersect
  for (const key of ['+', '-']) {
    await viewer.keyboard.press(key);
    await expect(viewer.locator('.message')).toContainText('the special cases are fixed');
    await expect(viewer.locator('#field')).toContainText('10 triangles against a');
  }
  await viewer.keyboard.press('w');
  await expect(viewer.locator('h1')).toHaveText('the ten special cases of 2012, reference moved');
  await viewer.keyboard.press('t');
  await expect(viewer.locator('h1')).toHaveText(before!);
});

test('random triangles are ten at first, one more or less by a key, against the reference of 2012', async ({
  viewer,
}) => {
  const shown = (many: string) => expect(viewer.locator('h1')).toHaveText(`${many} of 2012, seed 1`);
  await viewer.keyboard.press('+');
  await shown('10 random triangles');
  for (const [c, x] of [2, -2, 4, 1, 5, -2, 1, -3, -3].entries())
    await expect(coordinate(viewer, c)).toHaveValue(String(x));
  await viewer.keyboard.press('+');
  await shown('11 random triangles');
  for (let i = 0; i < 10; ++i) await viewer.keyboard.press('-');
  await shown('1 random triangle');
  await viewer.keyboard.press('-');
  await shown('1 random triangle');
});

test('i and c label every triangle if there is room, otherwise the nearest', async ({ page }) => {
  test.skip(!file(), 'this build has no viewer');
  const folder = dirname(file()),
    names = page.locator('#board svg text');
  await page.addInitScript(without_webgl);
  for (const [many, numbers, coordinates] of [
    [10, 10, 30],
    [60, 30, 30],
  ]) {
    execFileSync(process.env.GRAZE!, ['view', '--random', String(many), '--out', 'random.html'], { cwd: folder });
    await page.goto(pathToFileURL(join(folder, 'random.html')).href);
    await expect(page.locator('h1')).toHaveText(`${many} random triangles of 2012, seed 1`);
    await expect(names.filter({ hasText: /^\d+$/ })).toHaveCount(numbers); // at first numbers are shown
    await page.locator('#board').focus();
    await page.keyboard.press('c');
    await expect(names.filter({ hasText: /\(.*, .*, .*\)/ })).toHaveCount(coordinates + 3); // and the reference's
    await expect(names.filter({ hasText: /^\d+$/ })).toHaveCount(10);
    await page.keyboard.press('i');
    await expect(names.filter({ hasText: /^\d+$/ })).toHaveCount(0);
    await page.keyboard.press('c');
    await expect(names).toHaveCount(0);
  }
  await page.keyboard.press('i');
  const numbered = names.filter({ hasText: /^\d+$/ });
  await expect(numbered).toHaveCount(30);
  const named = await numbered.allTextContents();
  await page.locator('button', { hasText: 'Take a hit' }).click();
  await expect(page.locator('h1')).toHaveText(/^thesis:1:\d+$/);
  expect(named).toContain((await page.locator('h1').textContent())!.replace('thesis:1:', ''));
});
