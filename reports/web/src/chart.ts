// SPDX-License-Identifier: Apache-2.0
// Common parts of the charts.

export const kChartStyle = { background: 'none', fontFamily: 'inherit', fontSize: '12px' };

// A screen reader sees a plot as one picture with the label `label`; Plot's names of its parts become data-mark.
export function named(plot: SVGSVGElement | HTMLElement, label: string) {
  for (const part of plot.querySelectorAll('[aria-label]')) {
    part.setAttribute('data-mark', part.getAttribute('aria-label')!);
    part.removeAttribute('aria-label');
  }
  plot.setAttribute('role', 'img');
  plot.setAttribute('aria-label', label);
  return plot;
}
