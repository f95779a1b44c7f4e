// SPDX-License-Identifier: Apache-2.0
// The colours of shares: magma (van der Walt and Smith 2015), perceptually uniform and suitable for colour-blind
// readers. The scale is the cube root of the share, which keeps differences visible both near 10^-4 and near 1/2.
// Each step is a class and a custom property, so dark mode needs only CSS. The worst share is the darkest colour on a
// white page, and the brightest on a dark page.
import { interpolateMagma } from 'd3-scale-chromatic';
import { h } from './dom';

const kSteps = 26;

// The colour step of a share; null for a share of zero, which has no colour.
function heat_step(share: number): number | null {
  if (!(share > 0)) return null;
  return Math.round(Math.cbrt(share) * (kSteps - 1));
}

export const heat_class = (share: number) => {
  const step = heat_step(share);
  return step === null ? 'none' : `h${step}`;
};

const heat_fill = (share: number) => {
  const step = heat_step(share);
  return step === null ? 'var(--heat-none)' : `var(--h${step})`;
};

function luminance(hex: string) {
  const [r, g, b] = [1, 3, 5]
    .map((i) => parseInt(hex.slice(i, i + 2), 16) / 255)
    .map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

function rules(dark: boolean) {
  let properties = '',
    classes = '';
  for (let step = 0; step < kSteps; ++step) {
    const t = step / (kSteps - 1);
    const colour = interpolateMagma(dark ? 0.2 + 0.78 * t : 0.98 - 0.8 * t);
    properties += `--h${step}:${colour};`;
    classes += `.h${step}{background:var(--h${step});color:${luminance(colour) > 0.179 ? '#000' : '#fff'}}`;
  }
  return `:root{${properties}}${classes}`;
}

export function heat_styles() {
  return h('style', {}, `${rules(false)}@media screen and (prefers-color-scheme:dark){${rules(true)}}`);
}

const kMostTimes = 32;
// The colour of a ratio of shares: no colour up to 1, and the strongest colour from kMostTimes upwards.
export const times_fill = (times: number) => heat_fill(Math.min(1, Math.log2(times) / Math.log2(kMostTimes)) ** 3);

function legend(describes: string, none: string, marks: [number, string][]) {
  const steps = Array.from({ length: kSteps }, (_, i) => h('i', { class: `h${i}` }));
  return h(
    'div',
    { class: 'heat-legend', role: 'img', 'aria-label': `Colour scale: ${describes}` },
    h('i', { class: 'none' }),
    h('span', {}, none),
    h(
      'span',
      { class: 'ramp' },
      steps,
      marks.map(([place, text]) => h('b', { style: `left:${100 * place}%` }, text)),
    ),
  );
}

export const heat_legend = () =>
  legend(
    'share of wrong verdicts; no colour if none is wrong',
    'none wrong',
    [0.001, 0.01, 0.1, 0.3, 1].map((share) => [Math.cbrt(share), share === 1 ? '100 %' : String(100 * share)]),
  );

export const times_legend = () =>
  legend(
    'how many times as often wrong as at the origin; no colour if not more often',
    'not more often',
    [2, 4, 8, 16, kMostTimes].map((times) => [Math.log2(times) / Math.log2(kMostTimes), `${times} ×`]),
  );
