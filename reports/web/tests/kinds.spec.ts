// SPDX-License-Identifier: Apache-2.0
// A card's title, sentence, lanes, table and histograms describe its kind consistently.
import { expect, open_card, test } from './page';

const place_of = (line: string) => line.split('/').at(-1)!;

// The report must have cards with and without a source line, and with a settled and an unsettled cause.
test('the cards cover all sorts of kinds', async ({ report }) => {
  const kinds = report.cards.map(({ kind }) => kind);
  expect(kinds.some(({ line }) => line) && kinds.some(({ line }) => !line)).toBe(true);
  expect(kinds.some(({ settled: [yes, of] }) => yes < of) && kinds.some(({ settled: [yes, of] }) => yes === of)).toBe(
    true,
  );
  expect(new Set(kinds.map(({ shape }) => shape)).size).toBeGreaterThan(1);
  expect(new Set(kinds.map(({ key }) => key)).size).toBe(kinds.length);
  expect([...kinds].sort((l, r) => r.pairs - l.pairs)).toEqual(kinds);
});

test('title, sentence, lanes and verdicts of a card do not contradict each other', async ({ page, report }) => {
  await page.locator('button', { hasText: 'Open all' }).click();
  await expect(page.locator('.card .kind-lanes .all')).toHaveCount(report.cards.length);
  const cards = await page.locator('.card').evaluateAll((all) =>
    all.map((card) => {
      // all at once, because separate queries take long
      const texts = (where: string) =>
        [...card.querySelectorAll(where)].map((one) => one.textContent!.replace(/\s+/g, ' ').trim());
      return {
        id: card.id,
        title: texts('summary .card-title'),
        count: texts('summary .card-count'),
        sentences: texts('.sentences li'),
        lanes: texts('.kind-lanes'),
        all: texts('.kind-lanes .all'),
        here: texts('.kind-lanes .here'),
        targets: texts('.verdicts thead th'),
        marked: [...card.querySelectorAll('.verdicts tbody tr')].flatMap((row) =>
          [...row.querySelectorAll('td')].flatMap((cell, column) =>
            cell.className === 'bad' ? [{ name: row.querySelector('th')!.textContent!, column }] : [],
          ),
        ),
      };
    }),
  );
  let partly = 0;
  for (const [i, { kind, sentences, verdicts }] of report.cards.entries()) {
    const card = cards[i];
    expect(card.id).toBe(`kind-${i + 1}`);
    expect(card.title).toEqual([
      `${kind.subject}: ${kind.cause}${kind.line ? ` at ${place_of(kind.line)}` : ''}, ${kind.shape} pairs`,
    ]);
    expect(card.count[0]).toMatch(
      new RegExp(
        `^${kind.pairs.toLocaleString('en-US')} pairs?, ${kind.signatures.toLocaleString('en-US')} signatures?$`,
      ),
    );
    const first = card.sentences[0];
    expect(first).toBe(sentences[0]);
    expect(first.startsWith(`${kind.subject}/`), first).toBe(true);
    expect(first).toContain(kind.line);
    // The table must mark exactly those lanes of the kind that the card calls wrong on the pair shown.
    const said = card.all[0].split(', ').map((lane) => `${kind.subject}/${lane}`);
    expect(said).toEqual(kind.lanes);
    const claimed = card.here.length > 0 ? card.here[0].split(', ').map((lane) => `${kind.subject}/${lane}`) : said;
    partly += card.here.length;
    const wrong = card.marked.map(({ name, column }) => `${name}/${card.targets[column]}`);
    expect(wrong.sort()).toEqual(
      verdicts
        .filter((verdict) => verdict.wrong)
        .map((verdict) => report.lanes[verdict.lane].id)
        .sort(),
    );
    expect(claimed.length).toBeGreaterThan(0);
    expect(claimed).toEqual(said.filter((lane) => wrong.includes(lane)));
    const [yes, of] = kind.settled,
      text = card.lanes[0];
    expect(text.includes('The cause is settled for')).toBe(yes < of);
    if (yes < of)
      expect(text).toContain(
        `settled for ${yes.toLocaleString('en-US')} of ${of.toLocaleString('en-US')} examined lanes`,
      );
  }
  expect(partly).toBeGreaterThan(0);
  expect(partly).toBeLessThan(report.cards.length);
});

test('the histograms show their numbers, which add up', async ({ page, report }) => {
  const with_sides = report.cards.findIndex(({ kind }) =>
    ['-', '0', '+'].every((sign) => Object.keys(kind.margins).some((bucket) => bucket.startsWith(sign))),
  );
  expect(with_sides).toBeGreaterThanOrEqual(0);
  for (const place of [0, 1, with_sides]) {
    const { kind } = report.cards[place],
      card = await open_card(page, place + 1);
    for (const [name, numbers, of] of [
      ['margins', kind.margins, kind.pairs],
      ['strata', kind.strata, null],
    ] as const) {
      const svg = card.locator(`.histogram.${name} svg`).first();
      await svg.scrollIntoViewIfNeeded();
      const alt = (await svg.getAttribute('aria-label'))!;
      const [title, ...rest] = alt.split(/: (.*)/s);
      const said = rest[0].split('; ').map((part) => Number(part.match(/[\d,]+$/)![0].replaceAll(',', '')));
      const sum = said.reduce((all, n) => all + n, 0);
      expect([...said].sort()).toEqual(Object.values(numbers).sort());
      expect(title).toContain(` ${sum.toLocaleString('en-US')} pair`);
      if (of !== null) expect(sum).toBe(of);
      const heights = await svg
        .locator('g[data-mark="bar"] rect')
        .evaluateAll((bars) =>
          bars.map((bar) => Math.max(Number(bar.getAttribute('height')), Number(bar.getAttribute('width')))),
        );
      expect(heights.filter((height) => height > 0).length).toBeGreaterThanOrEqual(said.length);
    }
    const margins = (await card.locator('.histogram.margins svg').first().getAttribute('aria-label'))!;
    for (const [bucket, word] of [
      ['-', 'deep'],
      ['+', 'apart'],
    ])
      expect(margins.includes(word)).toBe(Object.keys(kind.margins).some((one) => one.startsWith(bucket)));
  }
});

test('the worst pair is named, with a command that explains it', async ({ page, report }) => {
  const place = report.cards.findIndex(
    ({ kind, pair }) => kind.worst.pair !== pair.hex.join(' ') && kind.worst.margin_ulps !== 0,
  );
  const { kind } = report.cards[place],
    worst = (await open_card(page, place + 1)).locator('.worst');
  await expect(worst).toContainText(kind.worst.from);
  await expect(worst).toContainText(kind.worst.margin_ulps < 0 ? 'ulps deep' : 'ulps apart');
  await worst.locator('[aria-label="Copy the command that explains the worst pair"]').click();
  expect(await page.evaluate(() => navigator.clipboard.readText())).toBe(
    `echo '${kind.worst.pair}' > worst.pairs; graze explain worst.pairs --lanes '${kind.subject}/*'`,
  );
  const same = report.cards.findIndex(({ kind: one, pair }) => one.worst.pair === pair.hex.join(' '));
  if (same >= 0)
    await expect((await open_card(page, same + 1)).locator('.worst')).toHaveText(
      /^The pair shown is also the worst examined pair/,
    );
});
