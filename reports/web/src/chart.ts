// SPDX-License-Identifier: Apache-2.0
// Common parts of the charts.

export const kChartStyle = { background: 'none', fontFamily: 'inherit', fontSize: '12px' };

// For a screen reader, a plot is one picture with the label `label`. The names that Plot gives to its parts are moved
// to data-mark.
export function named(plot: SVGSVGElement | HTMLElement, label: string) {
  for (const part of plot.querySelectorAll('[aria-label]')) {
    part.setAttribute('data-mark', part.getAttribute('aria-label')!);
    part.removeAttribute('aria-label');
  }
  plot.setAttribute('role', 'img');
  plot.setAttribute('aria-label', label);
  return plot;
}
