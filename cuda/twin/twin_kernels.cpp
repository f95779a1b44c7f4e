// SPDX-License-Identifier: Apache-2.0
// The twins' block functions, which run the generated kernels (GRAZE_TWIN_KERNELS). This file is compiled once for each
// variant in its own namespace GRAZE_FP, without contraction by the host's compiler. Define nothing else here, or the
// linker would mix the variants.
#include <string_view>
#include <tuple>
#include <type_traits>

#include "core/decide_each.h"
#include "cuda/lanes/device_pairs.h"
#include "cuda/twin/twin_ops_bits.h"
#include "cuda/twin/twin_table.h"
#ifndef __wasm__  // WebAssembly only rounds to nearest, which is enough for the published algorithms
#include "cuda/twin/twin_ops_rounding.h"
#endif

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

// A kernel's parameters have the device's layout: addresses have 64 bits, even on processors with shorter addresses.
u64 address(const void* object) { return reinterpret_cast<std::uintptr_t>(object); }
struct Block {
  u64 coordinates;
  u32 stride = 1, count = 1;
  template <class Real>
  explicit Block(const BasicPair<Real>& pair) : coordinates(address(graze::coordinates(pair))) {}
};
static_assert(sizeof(Block) == 16 && ((sizeof(DevicePairs) == 16 && sizeof(DeviceDoubles) == 16) || sizeof(void*) < 8));

// Decides one pair as a block of one pair. With stride 1, the pair's coordinates serve as the 18 arrays. `more` are the
// kernel's parameters between the block and the output words.
template <class Kernel, class Real, class Fuse, class... More>
Verdict decide_one(const BasicPair<Real>& pair, const Fuse& fuse, const More&... more) {
  const Block block(pair);
  u32 yes = 0, no_answer = 0;
  const u64 yes_at = address(&yes), no_answer_at = address(&no_answer);
  const unsigned char* const parameters[] = {bytes(&block), bytes(&more)..., bytes(&yes_at), bytes(&no_answer_at)};
  Kernel::run(parameters, fuse);
  return yes ? Verdict::intersects : no_answer ? Verdict::declined : Verdict::disjoint;
}

template <class Kernel, class AnyPair>
void decide_block(const AnyPair* pairs, std::size_t count, u64* intersects, u64* declined) {
  decide_each(pairs, count, intersects, declined,
              [](const AnyPair& pair) { return decide_one<Kernel>(pair, AllFused{}); });
}

template <class Kernel, class AnyPair>
void decide_within(const Epsilons& epsilons, const AnyPair* pairs, std::size_t count, u64* intersects, u64* declined) {
  const Tolerances<std::conditional_t<Kernel::kScalar == Scalar::f32, float, double>> tolerances(epsilons);
  decide_each(pairs, count, intersects, declined,
              [&](const AnyPair& pair) { return decide_one<Kernel>(pair, AllFused{}, tolerances); });
}

template <class Kernel, class AnyPair>
void trace_block(const AnyPair* pairs, std::size_t count, u64* hashes) {
  for (std::size_t i = 0; i < count; ++i) {
    const Block block(pairs[i]);
    const u64 hash_at = address(hashes + i);
    const unsigned char* const parameters[] = {bytes(&block), bytes(&hash_at)};
    Kernel::run(parameters, AllFused{});
  }
}

template <class Kernel, class AnyPair, class Fuse>
void record_each(const AnyPair* pairs, std::size_t count, const Records& to, const Fuse& fuse) {
  constexpr std::size_t kSize = Kernel::kScalar == Scalar::f32 ? sizeof(float) : sizeof(double);
  for (std::size_t i = 0; i < count; ++i) {
    const Block block(pairs[i]);
    to.paths[i] = {};
    const struct { u64 values, stride; } where{address(static_cast<char*>(to.values) + i * kSize), to.stride};
    const u64 path_at = address(to.paths + i);
    const unsigned char* const parameters[] = {bytes(&block), bytes(&where), bytes(&path_at)};
    Kernel::run(parameters, fuse);
  }
}

template <class Kernel, class AnyPair>
void record_block(const AnyPair* pairs, std::size_t count, const Records& to) {
  record_each<Kernel>(pairs, count, to, AllFused{});
}

template <class Kernel, class AnyPair>
void record_fusing(const AnyPair* pairs, std::size_t count, const Records& to, const u64* fused) {
  record_each<Kernel>(pairs, count, to, SomeFused{fused});
}

template <class Kernel, class AnyPair>
Verdict decide_fusing(const AnyPair& pair, const u64* fused) {
  return decide_one<Kernel>(pair, SomeFused{fused});
}

template <class Kernel, class AnyPair>
constexpr void enter_decide(TwinFunctions<AnyPair>& twin) {
  twin.decide = decide_block<Kernel, AnyPair>;
  twin.hash = Kernel::kHash;
  twin.symbol = Kernel::kSymbol;
  if constexpr (Kernel::kSiteCount > 0) {
    twin.decide_fusing = decide_fusing<Kernel, AnyPair>;
    twin.sites = std::span<const ContractionSite>(Kernel::kSites, Kernel::kSiteCount);
  }
}

template <class Kernel, class AnyPair>
constexpr void enter_trace(TwinFunctions<AnyPair>& twin) {
  twin.trace = trace_block<Kernel, AnyPair>;
  twin.trace_hash = Kernel::kHash;
  twin.trace_symbol = Kernel::kSymbol;
}

template <class Kernel, class AnyPair>
constexpr void enter_record(TwinFunctions<AnyPair>& twin) {
  twin.record = record_block<Kernel, AnyPair>;
  if constexpr (Kernel::kSiteCount > 0) {
    twin.record_fusing = record_fusing<Kernel, AnyPair>;
    twin.sites = std::span<const ContractionSite>(Kernel::kSites, Kernel::kSiteCount);
  }
}

template <class Kernel>
constexpr void enter(TwinTable& table) {
  TwinRow& row = table.rows[static_cast<std::size_t>(Kernel::kInteger)][static_cast<std::size_t>(Kernel::kScalar)];
  if constexpr (Kernel::kName == "decide_pairs") {
    enter_decide<Kernel, Pair>(row);
  } else if constexpr (Kernel::kName == "trace_pairs") {
    enter_trace<Kernel, Pair>(row);
  } else if constexpr (Kernel::kName == "record_pairs") {
    enter_record<Kernel, Pair>(row);
  } else if constexpr (Kernel::kName == "absolute_pairs") {
    row.absolute = decide_within<Kernel, Pair>;
  } else if constexpr (Kernel::kName == "relative_pairs") {
    row.relative = decide_within<Kernel, Pair>;
#ifndef GRAZE_FLOAT32_ALONE
  } else if constexpr (Kernel::kName == "decide_double_pairs") {
    enter_decide<Kernel, DoublePair>(row.doubles);
  } else if constexpr (Kernel::kName == "trace_double_pairs") {
    enter_trace<Kernel, DoublePair>(row.doubles);
  } else if constexpr (Kernel::kName == "absolute_double_pairs") {
    row.doubles.absolute = decide_within<Kernel, DoublePair>;
  } else if constexpr (Kernel::kName == "relative_double_pairs") {
    row.doubles.relative = decide_within<Kernel, DoublePair>;
  } else if constexpr (Kernel::kName == "record_double_pairs") {
    enter_record<Kernel, DoublePair>(row.doubles);
#endif
  }
}

template <class... Kernel>
constexpr TwinTable table_of(const std::tuple<Kernel...>*) {
  TwinTable table{};
  (enter<Kernel>(table), ...);
  return table;
}

}  // namespace ptx

extern const TwinTable kTwinTable = ptx::table_of(static_cast<const ptx::Kernels*>(nullptr));

}  // namespace GRAZE_FP

}  // namespace graze::cuda
