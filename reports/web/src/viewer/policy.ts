// SPDX-License-Identifier: Apache-2.0
// One policy for all lanes: how they compare with zero.
import { choice, h } from '../dom';
import { figure } from '../format';
import type { Model } from './model';

export function policy(model: Model) {
  let kind = '';
  const slider = h('input', {
    type: 'range',
    min: -30,
    max: 10,
    step: 0.5,
    value: -10,
    'aria-label': 'Epsilon, a power of two',
  });
  const told = h('output', { class: 'small' });
  function apply() {
    const epsilon = 2 ** (kind === 'rel' ? (Number(slider.value) + 30) / 2 : Number(slider.value));
    const number = kind === 'abs' || kind === 'rel';
    slider.hidden = !number;
    told.textContent =
      kind === 'abs'
        ? `smaller than ${figure(epsilon)}, in the unit compared`
        : kind === 'rel'
          ? `smaller than ${figure(epsilon)} machine epsilons of its size`
          : '';
    model.set_policy(number ? `${kind}:${epsilon}` : kind);
  }
  slider.addEventListener('input', apply);
  slider.hidden = true;
  return h(
    'div',
    { class: 'controls policy' },
    choice(
      'Treated as zero',
      [
        ['', 'only zero, as published'],
        ['abs', 'small values (abs:E)'],
        ['rel', 'values that are small for their size (rel:K)'],
        ['bound', 'nothing; unsure lanes decline (bound)'],
        ['filtered', 'nothing; unsure lanes use the exact decision (filtered)'],
      ],
      '',
      (value) => {
        kind = value;
        apply();
      },
    ),
    slider,
    told,
  );
}
