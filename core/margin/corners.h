// SPDX-License-Identifier: Apache-2.0
// Triangles in registers: loops, selections and approximate reciprocals that are cheap on a device.
#pragma once

#include <cmath>

#include "core/vec3.h"

// Unrolls loops over arrays. A device can then keep the arrays in registers, which cannot be indexed.
#ifdef __CUDA_ARCH__
#define GRAZE_UNROLL _Pragma("unroll")
#else
#define GRAZE_UNROLL
#endif

namespace graze {
inline namespace GRAZE_FP {
namespace first_attempt {

using Vec = Vec3<double>;
template <class Real>
using Corners = Vec3<Real>[3];

// 1 / x and 1 / sqrt(x) to 22 bits: for guesses, and for bounds together with kUp and kDown.
GRAZE_HD inline float reciprocal(float x) {
#ifdef __CUDA_ARCH__
  return __fdividef(1, x);
#else
  return 1 / x;
#endif
}
GRAZE_HD inline double reciprocal(double x) { return static_cast<double>(reciprocal(static_cast<float>(x))); }
GRAZE_HD inline float reciprocal_root(float x) {
#ifdef __CUDA_ARCH__
  return rsqrtf(x);
#else
  return 1 / sqrtf(x);
#endif
}

// Selects u or v. Like `turn`, it neither branches nor indexes; on a device, indexing would move registers to memory.
template <class Real>
GRAZE_HD void choose(bool first, const Corners<Real>& u, const Corners<Real>& v, Corners<Real>& chosen) {
  for (int k = 0; k < 3; ++k) chosen[k] = {first ? u[k].x : v[k].x, first ? u[k].y : v[k].y, first ? u[k].z : v[k].z};
}

// The triangle v, starting at vertex number `first`.
template <class Real>
GRAZE_HD void turn(const Corners<Real>& v, int first, Corners<double>& turned) {
  const auto at = [&](int k) -> Vec {
    return {double(k == 0   ? v[0].x
                   : k == 1 ? v[1].x
                            : v[2].x),
            double(k == 0   ? v[0].y
                   : k == 1 ? v[1].y
                            : v[2].y),
            double(k == 0   ? v[0].z
                   : k == 1 ? v[1].z
                            : v[2].z)};
  };
  turned[0] = at(first);
  turned[1] = at(first == 2 ? 0 : first + 1);
  turned[2] = at(first == 0 ? 2 : first - 1);
}

}  // namespace first_attempt
}  // namespace GRAZE_FP
}  // namespace graze
