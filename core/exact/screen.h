// SPDX-License-Identifier: Apache-2.0
// The screen: the decision by planes in doubles, with one error bound for the whole pair. It decides most pairs. There
// is an SSE2 version and a portable one, and both decide alike.
#pragma once

#include "core/exact/sides.h"
#if defined(__SSE2__) && !defined(__CUDACC__)
#include "core/exact/screen_sse2.h"
#else
#include "core/exact/screen_portable.h"
#endif

namespace graze::exact::detail {

// Requires: finite coordinates.   Returns: disjoint, crosses, or unsure if a determinant is within its error bound.
GRAZE_HD inline Finding screen(const float* a, const float* b) {
#if defined(__SSE2__) && !defined(__CUDACC__)
  return sse2::screen(a, b);
#else
  return portable::screen(a, b);
#endif
}

}  // namespace graze::exact::detail
