// SPDX-License-Identifier: Apache-2.0
// Functions for pairs of each coordinate type. The modules and reference.cpp use them.
#pragma once

#include <algorithm>
#include <cmath>

#include "analysis/lane_trace.h"
#include "core/margin/margin.h"
#include "core/margin/scaled_pair.h"
#include "cuda/twin/twin.h"
#include "strata/strata.h"

namespace graze::wasm {

inline void draw(Pair& pair, std::uint64_t seed, strata::Stratum stratum, std::uint64_t index) {
  pair = strata::generate(seed, stratum, index);
}
inline void draw(DoublePair& pair, std::uint64_t seed, strata::Stratum stratum, std::uint64_t index) {
  pair = strata::generate_doubles(seed, stratum, index);
}

// Certified bounds of |margin| in the unit of the coordinates. For doubles, the bounds are 0 and infinity if the
// exponents of the coordinates are too far apart for core/margin's number types. Requires: finite coordinates;
// `verdict` is the pair's true verdict, not declined.
inline MarginBounds bounds_of(const Pair& pair, Verdict verdict) { return margin_bounds(pair, verdict); }
inline MarginBounds bounds_of(const DoublePair& pair, Verdict verdict) {
  const ScaledPair scaled(pair);
  if (!scaled.fits) return {0, INFINITY, 0, 0};
  MarginBounds bounds = margin_bounds<DoubleDouble>(scaled.pair, verdict);
  const int shift = log2_ulp(pair) - scaled.ulp;
  const auto shifted = [&](double x, double outward) {
    const double y = std::ldexp(x, shift);
    return std::ldexp(y, -shift) == x ? y : std::nextafter(y, outward);  // a subnormal or infinite y may be rounded
  };
  bounds.lo = std::max(0.0, shifted(bounds.lo, -INFINITY));
  bounds.hi = shifted(bounds.hi, INFINITY);
  return bounds;
}

// The lane's trace hash on the pair, which a float lane first rounds to float32. Requires: a lane with a twin.
inline std::uint64_t trace_of(const Lane& lane, const AnyPair& pair) {
  std::uint64_t hash = 0;
  const AnyPair seen = analysis::seen_by(lane, pair);
  if (seen.floats) {
    cuda::twin_row(lane).trace(&*seen.floats, 1, &hash);
  } else {
    cuda::twin_row(lane).doubles.trace(&seen.doubles, 1, &hash);
  }
  return hash;
}

}  // namespace graze::wasm
