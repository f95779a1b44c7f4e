// SPDX-License-Identifier: Apache-2.0
// Common parts of the charts, and the appearance of lanes in them: colour by algorithm (Okabe and Ito 2008; style.css
// has shades for light and dark pages), dashes by target, width by scalar.
import { figure } from './format';
import type { Report } from './report';

// The size, margins and style of a plot.
export const frame = (width: number, height: number, [top, right, bottom, left]: [number, number, number, number]) => ({
  width,
  height,
  marginTop: top,
  marginRight: right,
  marginBottom: bottom,
  marginLeft: left,
  style: { background: 'none', fontFamily: 'inherit', fontSize: '12px' },
});

// Shows the plot to screen readers as one image with this label. Moves the labels of the plot's parts to data-mark.
export function named(plot: SVGSVGElement | HTMLElement, label: string) {
  for (const part of plot.querySelectorAll('[aria-label]')) {
    part.setAttribute('data-mark', part.getAttribute('aria-label')!);
    part.removeAttribute('aria-label');
  }
  plot.setAttribute('role', 'img');
  plot.setAttribute('aria-label', label);
  return plot;
}

// A logarithmic axis for shares (powers of ten). Shares of zero lie on a line below the lowest power of ten.
export function shares_axis(shares: number[]) {
  const floor = Math.floor(Math.log10(Math.min(0.01, ...shares.filter((s) => s > 0)))),
    none = floor - 0.7;
  const decades = Array.from({ length: -floor + 1 }, (_, i) => floor + i);
  return {
    none,
    place: (s: number) => (s > 0 ? Math.max(none, Math.log10(s)) : none),
    options: {
      domain: [none, 0],
      ticks: [none, ...decades],
      tickFormat: (v: number) => (v === none ? 'none' : `${figure(100 * 10 ** v)} %`),
    },
  };
}

// The label of a horizontal axis, centred below it.
export const x_label = (label: string | null, labelOffset: number) =>
  ({ label, labelAnchor: 'center', labelArrow: 'none', labelOffset }) as const;

export function series_colour(report: Report, algorithm: string): string {
  const algorithms = [...new Set(report.lanes.map((lane) => lane.algorithm))];
  return `var(--series-${algorithms.indexOf(algorithm) % 6})`;
}

const kDashes: Record<string, string> = { 'cpu-fma': '7 3', 'cuda-nofma': '2 3', 'cuda-fma': '9 3 2 3' };

export const series_dash = (target: string) => kDashes[target] ?? '';
export const series_width = (scalar: string) => (scalar === 'f64' ? 1.2 : 2.2);
