// SPDX-License-Identifier: Apache-2.0
// The twins' block functions of lanes under tolerances, as cuda/twin/twin_kernels.cpp has those of lanes under none.
// Compiled once for each variant with a twin, in a namespace of its own, for any processor.
#include <string_view>
#include <tuple>

#include "cuda/lanes/device_pairs.h"
#include "cuda/twin/twin_ops_bits.h"
#include "cuda/twin/twin_ops_rounding.h"
#include "cuda/twin/twin_table.h"

namespace graze::cuda {
inline namespace GRAZE_FP {
namespace ptx {

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-label"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wconversion"
#include GRAZE_TWIN_KERNELS
#pragma GCC diagnostic pop

const unsigned char* bytes(const void* object) { return static_cast<const unsigned char*>(object); }

// Each pair as a block of one: stride 1, so that its coordinates are the 18 arrays.
template <class Kernel, class Real>
void decide_within(const Epsilons& epsilons, const Pair* pairs, std::size_t count, u64* intersects, u64* declined) {
  const Tolerances<Real> tolerances(epsilons);
  for (std::size_t word = 0; word * 64 < count; ++word) {
    intersects[word] = declined[word] = 0;
    for (std::size_t bit = 0; bit < 64 && word * 64 + bit < count; ++bit) {
      const DevicePairs block{coordinates(pairs[word * 64 + bit]), 1, 1};
      u32 yes = 0, no_answer = 0;
      const u32 *yes_at = &yes, *no_answer_at = &no_answer;
      const unsigned char* const parameters[] = {bytes(&block), bytes(&tolerances), bytes(&yes_at),
                                                 bytes(&no_answer_at)};
      Kernel::run(parameters, AllFused{});
      intersects[word] |= u64{yes != 0} << bit;
      declined[word] |= u64{no_answer != 0} << bit;
    }
  }
}

template <class Kernel>
constexpr void enter(PolicyTwinTable& table) {
  PolicyTwinRow& row = table[static_cast<std::size_t>(Kernel::kInteger)][static_cast<std::size_t>(Kernel::kScalar)];
  DecideBlock::Within& entry = Kernel::kName == "absolute_pairs" ? row.absolute : row.relative;
  if constexpr (Kernel::kScalar == Scalar::f32) {
    entry = decide_within<Kernel, float>;
  } else {
    entry = decide_within<Kernel, double>;
  }
}

template <class... Kernel>
constexpr PolicyTwinTable table_of(const std::tuple<Kernel...>*) {
  PolicyTwinTable table{};
  (enter<Kernel>(table), ...);
  return table;
}

}  // namespace ptx

extern const PolicyTwinTable kPolicyTwins = ptx::table_of(static_cast<const ptx::Kernels*>(nullptr));

}  // namespace GRAZE_FP
}  // namespace graze::cuda
