// SPDX-License-Identifier: Apache-2.0
// Recording runs of the host lanes, compiled once per variant like host_blocks.cpp. Define nothing else here, or the
// linker may mix the variants.
#include "core/algorithms/recording.h"
#include "core/lanes/host_blocks.h"

namespace graze {
inline namespace GRAZE_FP {

template <class Algorithm, class Real>
void record_block(const Pair* pairs, std::size_t count, const Records& to) {
  for (std::size_t i = 0; i < count; ++i) {
    Vec3<Real> a[3], b[3];
    for (int v = 0; v < 3; ++v) {
      a[v] = {Real(pairs[i].a[v].x), Real(pairs[i].a[v].y), Real(pairs[i].a[v].z)};
      b[v] = {Real(pairs[i].b[v].x), Real(pairs[i].b[v].y), Real(pairs[i].b[v].z)};
    }
    to.paths[i] = record<Algorithm>(a, b, Recorded<Real>{static_cast<Real*>(to.values) + i, to.stride});
  }
}

template <class... Algorithm>
constexpr BlockTable<RecordBlock> record_blocks(const std::tuple<Algorithm...>*) {
  return {std::array<RecordBlock, 2>{record_block<Algorithm, float>, record_block<Algorithm, double>}...};
}

extern const BlockTable<RecordBlock> kHostRecords = record_blocks(static_cast<const Algorithms*>(nullptr));

}  // namespace GRAZE_FP
}  // namespace graze
