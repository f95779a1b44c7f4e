// SPDX-License-Identifier: Apache-2.0
// Method and definitions, in plain words.
import { h, marked, paragraph, section } from './dom';

const kTerms = [
  [
    'Pair',
    'Two triangles, given by 18 float32 numbers, or by 18 doubles in strata whose names end with `/f64`. The stored bits are the input: nothing rounds them again, except that a lane in float32 decides a pair of doubles as float32 stores it.',
  ],
  ['Triangle', 'The closed convex hull of its three points, so a degenerate triangle is a segment or a point.'],
  [
    'Intersects',
    'The two sets share at least one point: touching counts. A *contact* is a point, a segment or an area.',
  ],
  [
    'Lane',
    'One way to decide a pair: algorithm/scalar/target. `cpu` rounds every operation; `cpu-fma` and `cuda-fma` let the compiler fuse a product and an addition into one rounding (contraction); `cuda-nofma` is nvcc with `-fmad=false`.',
  ],
  [
    'Twin',
    'A replay of a CUDA kernel’s PTX on the CPU, including its contractions, with the same bits. “Verified on” a GPU means that the GPU and the twin had the same verdicts and the same deciding numbers, on as many pairs as the first number says. Explicit PTX is the kernel with every contraction written out. The twin is made from explicit PTX, which was compared on the GPU with nvcc’s default build.',
  ],
  [
    'Stratum',
    'A named generator of pairs: a pure function of seed and index. Each stratum is hard in its own way. Shares over all strata depend on the mix of strata and say nothing about your data. Shares within a stratum can be true of your data.',
  ],
  [
    'Truth',
    'CGAL’s exact kernel decides; an independent decision on integers of any size (GMP) confirms every disagreement that is kept. With `--judge exact` or `--engine gpu`, Graze’s own exact decision comes first; CGAL and GMP then decide every disagreement that is kept, and a sample of the other pairs. If two of them ever differ, the campaign stops.',
  ],
  [
    'False positive, false negative',
    'False positive: the lane says “intersects” about triangles that are apart. False negative: it says “disjoint” about triangles that meet. Each share counts only the pairs on which that error is possible; the share “wrong” counts all pairs. *Declined* is neither of these errors.',
  ],
  [
    'Margin',
    'How far a pair is from changing its verdict. For a disjoint pair, the margin is the distance. For an intersecting pair, it is the length of the shortest translation that separates the triangles; charts show these pairs on the left. It is 0 if an arbitrarily short translation separates them, as for touching or coplanar pairs. The margin is computed exactly, then rounded once.',
  ],
  [
    'Ulp',
    'The step between neighbouring numbers of the coordinates’ type, float32 or double, at the pair’s largest coordinate. Margins are given in ulps, so that the pair’s size does not matter.',
  ],
  [
    'Interval',
    'Wilson’s interval at 95 % confidence. If no error was seen in n pairs, the rate is below 1 − 0.05^(1/n), about 3/n, with 95 % confidence.',
  ],
  [
    'Kind of failure',
    'Signatures with the same algorithm, cause (rounding, overflow, underflow, contraction, fast math, or the algorithm’s own logic), source line of the comparison that decides, and shape. The shape is *degenerate* if a triangle is a segment or a point, otherwise *contained* if one triangle lies in the other in the same plane, otherwise *coplanar* or *general*. A cause is *settled* for a lane if the verdict becomes right without the cause and remains wrong with that cause alone.',
  ],
  [
    'Signature',
    'Failures of an algorithm that look alike: the contact, the dimensions of both triangles (2 is a proper triangle), coplanar or skew, which triangle lies in the other, the margin’s power of two, and the mark of each lane: `+` false positive, `-` false negative, `?` declined, `.` right.',
  ],
  [
    'Minimised',
    'A minimised pair was made simpler step by step, while the same lanes failed in the same way, until no single step made it simpler.',
  ],
  [
    'Ulp map',
    'The verdicts around a case: two coordinates move by single ulps, one step a pixel, after Kettner, Mehlhorn, Pion, Schirra and Yap (Classroom examples of robustness problems in geometric computations, 2008). A lane that is right on all these pairs has the same picture as the truth.',
  ],
];

export function method_section() {
  return section(
    'method',
    'Method and definitions',
    paragraph(
      'Every pair is drawn by its stratum, decided by every lane, and judged by exact arithmetic. This page recomputes nothing: it shows the numbers of the campaign’s summary and cases.',
    ),
    h(
      'dl',
      { class: 'terms' },
      kTerms.map(([term, text]) => h('div', {}, h('dt', {}, term), h('dd', {}, marked(text)))),
    ),
  );
}
