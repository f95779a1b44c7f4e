// SPDX-License-Identifier: Apache-2.0
// An algorithm of the 2012 thesis as a subject, for any compiler and flags, for example for the x87:
//   --subject x87=subjects/examples/interval_overlap.cpp --flags="-I$PWD -mfpmath=387"
#include "core/algorithms/interval_overlap.h"

bool intersects(const float a[9], const float b[9]) {
  const auto corner = [](const float* p) { return graze::Vec3<float>{p[0], p[1], p[2]}; };
  const graze::Vec3<float> p[3] = {corner(a), corner(a + 3), corner(a + 6)};
  const graze::Vec3<float> q[3] = {corner(b), corner(b + 3), corner(b + 6)};
  return graze::IntervalOverlap::decide(p, q) == graze::Verdict::intersects;
}
