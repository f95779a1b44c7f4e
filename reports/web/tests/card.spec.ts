// SPDX-License-Identifier: Apache-2.0
import { expect, open_card, pixels, test } from './page';

test.describe('by WebGL', () => {
  test.use({ webgl: true });
  test('dragging and keys turn the drawing, and it can be reset', async ({ page }) => {
    const card = await open_card(page, 1);
    const board = card.locator('.board');
    await expect(board).not.toHaveClass(/flat/); // drawn by WebGL
    await page.waitForTimeout(200);
    const still = await pixels(board.locator('canvas'));
    expect(still.length).toBeGreaterThan(2000); // something is drawn
    const box = (await board.boundingBox())!;
    await page.mouse.move(box.x + 100, box.y + 100);
    await page.mouse.down();
    await page.mouse.move(box.x + 180, box.y + 130, { steps: 4 });
    await page.mouse.up();
    const dragged = await pixels(board.locator('canvas'));
    expect(dragged).not.toBe(still);
    await board.focus();
    await page.keyboard.press('ArrowLeft');
    const turned = await pixels(board.locator('canvas'));
    expect(turned).not.toBe(dragged);
    await page.keyboard.press('ArrowUp');
    expect(await pixels(board.locator('canvas'))).not.toBe(turned);
    await card.locator('button', { hasText: 'Reset' }).click();
    await board.evaluate((element) => (element as HTMLElement).blur());
    await page.mouse.move(0, 0);
    expect(await pixels(board.locator('canvas'))).toBe(still);
  });

  test('every card has a drawing, all from one WebGL context', async ({ page, report }) => {
    await page.setViewportSize({ width: 400, height: 400 }); // small drawings
    await page.locator('button', { hasText: 'Open all' }).click();
    for (let number = 1; number <= report.cards.length; ++number) {
      const board = page.locator(`#kind-${number} .board`);
      await board.scrollIntoViewIfNeeded();
      await expect(async () => {
        const painted = await board.locator('canvas').evaluate((canvas: HTMLCanvasElement) => {
          const copy = new OffscreenCanvas(canvas.width / 4, canvas.height / 4).getContext('2d', {
            willReadFrequently: true,
          })!;
          copy.drawImage(canvas, 0, 0, copy.canvas.width, copy.canvas.height);
          return copy.getImageData(0, 0, copy.canvas.width, copy.canvas.height).data.some((value) => value > 0);
        });
        expect(painted).toBe(true);
      }).toPass({ timeout: 30_000 });
    }
  });
});

test('a card agrees with the report', async ({ page, report }) => {
  const number =
    1 +
    Math.max(
      0,
      report.cards.findIndex((card) => card.maps),
    );
  const data = report.cards[number - 1];
  const card = await open_card(page, number);
  await expect(card.locator('.truth').first()).toContainText(data.truth.verdict);
  for (const text of [...data.sentences, ...data.pair.hex, ...data.pair.decimal])
    await expect(card).toContainText(text);
  await expect(card.locator('.verdicts .bad')).toHaveCount(data.verdicts.filter((verdict) => verdict.wrong).length);
  const images = card.locator('.panel img');
  await expect(images).toHaveCount(data.maps?.panels.length ?? 0);
  for (const image of await images.all()) {
    expect(await image.evaluate((img: HTMLImageElement) => img.decode().then(() => img.naturalWidth))).toBe(
      data.maps!.size,
    );
  }
});

test('commands, coordinates and snippets are copied', async ({ page, report }) => {
  const data = report.cards[0];
  const card = await open_card(page, 1);
  const clipboard = () => page.evaluate(() => navigator.clipboard.readText());
  await page.locator('#run .copy').first().click();
  expect(await clipboard()).toBe(report.run.command);
  for (const { label, text } of data.commands) {
    await card.locator(`[aria-label="Copy the ${label} command"]`).click();
    expect(await clipboard()).toBe(text);
  }
  await card.locator('[aria-label="Copy the coordinates"]').click();
  expect(await clipboard()).toBe(data.pair.hex.join(' '));
  for (const { label, text } of data.snippets) {
    await card.locator('.snippets button', { hasText: new RegExp(`^${label}$`) }).click();
    await card.locator(`[aria-label="Copy the ${label} snippet"]`).click();
    expect(await clipboard()).toBe(text.replace('@SOURCE@', () => report.sources[data.kind.subject]));
  }
});

test('without WebGL, the drawing is an SVG that turns', async ({ page }) => {
  const card = await open_card(page, 1);
  const svg = card.locator('.paper svg');
  await expect(card.locator('.board')).toHaveClass(/flat/);
  await expect(svg).toBeVisible();
  await expect(svg.locator('polygon.triangle-a, polygon.triangle-b')).toHaveCount(2);
  const still = await svg.innerHTML();
  await card.locator('.board').focus();
  await page.keyboard.press('ArrowRight');
  expect(await svg.innerHTML()).not.toBe(still);
});
