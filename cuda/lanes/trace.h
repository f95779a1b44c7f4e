// SPDX-License-Identifier: Apache-2.0
// A policy that compares exactly and hashes every value that it receives: signed distances, orientations, components of
// the normals' cross product, and interval ends. Two runs with the same hash computed the same intermediate bits.
#pragma once

#include <cstdint>
#include <cstring>

#include "core/epsilon_sites.h"

namespace graze::cuda {
inline namespace GRAZE_FP {

// The order of the values matters. All NaNs count as one value: their signs and payloads differ by processor.
struct TracePolicy {
  std::uint64_t* hash;

  template <class Real>
  GRAZE_HD void fold(const Real& x) const {
    std::uint64_t bits = 0;
    memcpy(&bits, &x, sizeof x);
    if (!(x == x)) bits = 0x7fffffffu;
    std::uint64_t h = (*hash ^ bits) * 0x9e3779b97f4a7c15u;  // 2^64 / golden ratio, as in Knuth's multiplicative hash
    *hash = h ^ h >> 32;
  }

  template <class Real>
  GRAZE_HD Real snap(Site, const Real& x) const {
    fold(x);
    return x;
  }

  template <class Real>
  GRAZE_HD bool less(Site, const Real& l, const Real& r) const {
    fold(l);
    fold(r);
    return l < r;
  }

  template <class Real>
  GRAZE_HD bool at_most(Site, const Real& l, const Real& r) const {
    fold(l);
    fold(r);
    return l <= r;
  }
};

}  // namespace GRAZE_FP
}  // namespace graze::cuda
