// SPDX-License-Identifier: Apache-2.0
// What the charts share.

export const kChartStyle = { background: 'none', fontFamily: 'inherit', fontSize: '12px' };

// A plot is one picture to a screen reader, named by `label`; Plot's names of its parts become data-mark.
export function named(plot: SVGSVGElement | HTMLElement, label: string) {
  for (const part of plot.querySelectorAll('[aria-label]')) {
    part.setAttribute('data-mark', part.getAttribute('aria-label')!);
    part.removeAttribute('aria-label');
  }
  plot.setAttribute('role', 'img');
  plot.setAttribute('aria-label', label);
  return plot;
}
