// SPDX-License-Identifier: Apache-2.0
// The filter: the decision by planes in doubles, with one error bound for the whole pair. It decides most pairs. It has
// an SSE2 version and a portable one, which give the same results.
#pragma once

#include "core/exact/sides.h"
#if defined(__SSE2__) && !defined(__CUDACC__)
#include "core/exact/filter_sse2.h"
#else
#include "core/exact/filter_portable.h"
#endif

namespace graze::exact::detail {

// Requires: finite coordinates.   Returns: disjoint, crosses, or unsure if a determinant is within its error bound.
template <class Real>
GRAZE_HD Finding filter(const Real* a, const Real* b) {
#if defined(__SSE2__) && !defined(__CUDACC__)
  return sse2::filter(a, b);
#else
  return portable::filter(a, b);
#endif
}

}  // namespace graze::exact::detail
