// SPDX-License-Identifier: Apache-2.0
// Method and definitions, in plain words.
import { h, section, type Child } from './dom';

const kTerms: [string, Child[]][] = [
  ['Pair', ['Two triangles, given by 18 float32 numbers. The stored bits are the input: nothing rounds them again.']],
  ['Triangle', ['The closed convex hull of its three points, so a degenerate one is a segment or a point.']],
  [
    'Intersects',
    [
      'The two sets share at least one point: touching counts. A ',
      h('i', {}, 'contact'),
      ' is a point, a segment or an area.',
    ],
  ],
  [
    'Lane',
    [
      'One way to decide a pair: algorithm/scalar/target. ',
      h('code', {}, 'cpu'),
      ' rounds every operation; ',
      h('code', {}, 'cpu-fma'),
      ' and ',
      h('code', {}, 'cuda-fma'),
      ' let the compiler fuse a product and an addition into one rounding (contraction); ',
      h('code', {}, 'cuda-nofma'),
      ' is nvcc with ',
      h('code', {}, '-fmad=false'),
      '.',
    ],
  ],
  [
    'Twin',
    [
      'A replay of a CUDA kernel’s PTX on the CPU, contractions and all, with the same bits. ',
      '“Verified on” a GPU means that GPU and twin agreed on as many pairs as the first number says, in verdicts and in the numbers that decide. Explicit PTX is the kernel with every contraction written out. The twin is made from it, and it was compared on the GPU with what nvcc builds by default.',
    ],
  ],
  [
    'Stratum',
    [
      'A named generator of pairs, a pure function of seed and index. Each is hard in its own way. Shares over all strata depend on the mix of strata and say nothing about your data; shares within a stratum can.',
    ],
  ],
  [
    'Truth',
    [
      'CGAL’s exact kernel decides; an independent decision on integers of any size (GMP) confirms every disagreement that is kept. If the two ever differ, the campaign stops.',
    ],
  ],
  [
    'False positive, false negative',
    [
      'False positive: the lane says “intersects” about triangles that are apart. False negative: it says “disjoint” about triangles that meet. Their shares are of the pairs on which that error is possible; the share “wrong” is of all pairs. ',
      h('i', {}, 'Declined'),
      ' is neither.',
    ],
  ],
  [
    'Margin',
    [
      'How close the call was. For a disjoint pair it is the distance. For an intersecting one it is the length of the smallest translation that separates it, drawn to the left; it is 0 if an arbitrarily small one does, as for touching or coplanar pairs. It is computed exactly, then rounded once.',
    ],
  ],
  [
    'Ulp',
    [
      'The step between neighbouring float32 numbers at the pair’s largest coordinate. Margins are given in ulps, so that the pair’s size does not matter.',
    ],
  ],
  [
    'Interval',
    [
      'Wilson’s, at 95 %. If no error was seen in n pairs, the rate is below 1 − 0.05^(1/n), about 3/n, with 95 % confidence.',
    ],
  ],
  [
    'Kind of failure',
    [
      'What signatures have in common: the algorithm, why it is wrong (rounding, overflow, underflow, contraction, fast math, or its own logic), the source line of the comparison that decides, and the shape: ',
      h('i', {}, 'degenerate'),
      ' if a triangle is a segment or a point, otherwise ',
      h('i', {}, 'contained'),
      ' if one lies in the other in the same plane, ',
      h('i', {}, 'coplanar'),
      ' or ',
      h('i', {}, 'general'),
      '. A cause is ',
      h('i', {}, 'settled'),
      ' for a lane if the verdict becomes right without it and stays wrong with it alone.',
    ],
  ],
  [
    'Signature',
    [
      'Failures of an algorithm that look alike: the contact, the dimensions of both triangles (2 is a proper triangle), coplanar or skew, which triangle lies in the other, the margin’s power of two, and the mark of each lane: ',
      h('code', {}, '+'),
      ' false positive, ',
      h('code', {}, '-'),
      ' false negative, ',
      h('code', {}, '?'),
      ' declined, ',
      h('code', {}, '.'),
      ' right.',
    ],
  ],
  [
    'Minimised',
    [
      'Made simpler step by step, as long as the same lanes fail in the same way, until no single step makes it simpler.',
    ],
  ],
  [
    'Ulp map',
    [
      'The verdicts around a case: two coordinates move by single ulps, one step a pixel, after Kettner, Mehlhorn, Pion, Schirra and Yap (Classroom examples of robustness problems in geometric computations, 2008). The picture of a lane that can be trusted is that of the truth.',
    ],
  ],
];

export function method_section() {
  return section(
    'method',
    'Method and definitions',
    h(
      'p',
      {},
      'Every pair is drawn by its stratum, decided by every lane, and judged by exact arithmetic. This page recomputes nothing: it shows the numbers of the campaign’s summary and cases.',
    ),
    h(
      'dl',
      { class: 'terms' },
      kTerms.map(([term, text]) => h('div', {}, h('dt', {}, term), h('dd', {}, text))),
    ),
  );
}
