// SPDX-License-Identifier: Apache-2.0
// The appearance of lanes in charts: colour by algorithm (Okabe and Ito 2008; style.css has shades for light and dark
// pages), dashes by target, width by scalar.
import type { Report } from './report';

export function series_colour(report: Report, algorithm: string): string {
  const algorithms = [...new Set(report.lanes.map((lane) => lane.algorithm))];
  return `var(--series-${algorithms.indexOf(algorithm) % 6})`;
}

const kDashes: Record<string, string> = { 'cpu-fma': '7 3', 'cuda-nofma': '2 3', 'cuda-fma': '9 3 2 3' };

export const series_dash = (target: string) => kDashes[target] ?? '';
export const series_width = (scalar: string) => (scalar === 'f64' ? 1.2 : 2.2);
