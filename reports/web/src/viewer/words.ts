// SPDX-License-Identifier: Apache-2.0
// Explanations of technical words on the page.
import { h } from '../dom';

const kWords = [
  ['lane', 'an algorithm in float32 (f32) or float64 (f64), as built for the CPU or the GPU: moller_1997/f32/cuda-fma'],
  ['truth', 'the exact answer for these coordinates, computed with integers of as many bits as it takes'],
  [
    'margin',
    'how far apart the triangles are, or the shortest push that separates them; 0 if an arbitrarily short one does',
  ],
  ['ulp', 'the step from a number to the next one in its format; margins are in ulps of the largest coordinate'],
  ['113 bits', 'numbers with 113 binary digits; float32 has 24, float64 53'],
  ['contraction', 'computing a * b + c with one rounding (a fused multiply-add) where the source has two operations'],
  ['twin', 'the GPU’s kernel replayed bit for bit on the CPU, so that this page needs no GPU'],
  ['declined', 'no verdict: a coordinate is not finite, or the lane is not sure'],
  ['stratum', 'a named generator of pairs; thesis:1:42 is pair 42 of thesis with seed 1'],
  [
    'native build',
    'the graze program that wrote this page; it stored its verdicts on some pairs, which this page decided again when it opened',
  ],
];

export const words = () =>
  h(
    'details',
    { id: 'words' },
    h('summary', {}, 'Words'),
    h(
      'dl',
      {},
      kWords.map(([word, means]) => [h('dt', {}, word), h('dd', {}, means)]),
    ),
  );
