// SPDX-License-Identifier: Apache-2.0
// Shows the verdicts of the user's own code. The page cannot run that code, so it has verdicts only for the pairs that
// were stored in the page.
import { h, section } from '../dom';
import { to_bits, type ViewData } from './data';
import type { Model } from './model';

export function own_code(model: Model, data: ViewData) {
  const said = new Map(data.pairs.map((one) => [one.bits, one.said ?? []]));
  const left_out = Object.entries(data.lanes_left_out?.why ?? {});
  const list = h('ul', { class: 'plain' }),
    told = h('p', { class: 'small' });
  const element = section('own-code', 'Your own code', told, list);
  element.hidden = left_out.length === 0 && data.pairs.every((one) => !one.said?.length);
  let before = '';

  function update() {
    const bits = to_bits(model.pair);
    if (element.hidden || bits === before) return;
    before = bits;
    const lanes = said.get(bits);
    const stored = lanes?.some((one) => one.stored);
    told.textContent = !lanes
      ? 'Your code ran only on the pairs of this page, not on this changed pair.'
      : stored
        ? 'Your code has changed since the campaign; these are the verdicts that the campaign stored.'
        : 'These are the verdicts of your code on this pair when the page was written.';
    list.replaceChildren(
      ...(lanes ?? []).map(({ lane, verdict, wrong }) =>
        h('li', { class: wrong ? 'bad' : '' }, `${lane}: ${wrong ? '✗ ' : ''}${verdict}`),
      ),
      ...left_out.map(([lane, why]) => h('li', { class: 'small' }, `${lane} did not run: ${why}`)),
    );
  }
  return { element, update };
}
