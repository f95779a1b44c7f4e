// SPDX-License-Identifier: Apache-2.0
// Recording runs of the host lanes in double on pairs of doubles, compiled once per variant. These runs have a
// separate file because contraction depends on what else the compiler sees: in one file with them, lanes on float32
// pairs could compute other values. Define nothing else here.
#include "core/algorithms/recording.h"
#include "core/lanes/host_blocks.h"

namespace graze {
inline namespace GRAZE_FP {

template <class Algorithm>
void record_doubles(const DoublePair* pairs, std::size_t count, const Records& to) {
  for (std::size_t i = 0; i < count; ++i) {
    const Recorded<double> values{static_cast<double*>(to.values) + i, to.stride};
    to.paths[i] = record<Algorithm>(pairs[i].a, pairs[i].b, values);
  }
}

template <class... Algorithm>
constexpr HostDoubleRecords double_records(const std::tuple<Algorithm...>*) {
  return {record_doubles<Algorithm>...};
}

extern const HostDoubleRecords kHostDoubleRecords = double_records(static_cast<const Algorithms*>(nullptr));

}  // namespace GRAZE_FP
}  // namespace graze
