// SPDX-License-Identifier: Apache-2.0
// The twins' functions: a table [algorithm][scalar] for each variant with a twin, each in its own namespace. Contracted
// kernels are compiled twice, for processors with and without FMA instructions. Both compilations give the same
// verdicts at different speeds.
#pragma once

#include <array>

#include "core/algorithms/algorithms.h"
#include "cuda/twin/twin.h"

namespace graze::cuda {

// The functions of the kernels for pairs of one coordinate type.
template <class AnyPair>
struct TwinFunctions {
  DecideFunction<AnyPair> decide = nullptr;
  DecideWithin<AnyPair> absolute = nullptr, relative = nullptr;  // only absolute tolerances; relative tolerances too
  TraceFunction<AnyPair> trace = nullptr;
  Verdict (*decide_fusing)(const AnyPair& pair, const std::uint64_t* fused) = nullptr;
  // The functions of the recording kernel, which is in a separate table, with its own `sites`.
  RecordFunction<AnyPair> record = nullptr;
  void (*record_fusing)(const AnyPair* pairs, std::size_t count, const Records& to,
                        const std::uint64_t* fused) = nullptr;
  // Hashes of the kernels' PTX and contractions, for which a record in cuda/proofs is valid. Empty without a twin.
  const char* hash = "";
  const char* trace_hash = "";
  const char* symbol = "";  // name of the kernel that the twin replays
  const char* trace_symbol = "";
  std::span<const ContractionSite> sites = {};
};

struct TwinRow : TwinFunctions<Pair> {
  TwinFunctions<DoublePair> doubles;  // for lanes in double
};

struct TwinTable {
  std::array<std::array<TwinRow, 2>, kAlgorithmCount> rows;
};

// twin_NAME for the variants with a twin; twin_NAME_portable for those with contraction. On all processors:
// policy_twin_NAME for lanes under tolerances, record_twin_NAME for recording lanes. Other names are never defined.
#define GRAZE_DECLARE(name)          \
  namespace name {                   \
  extern const TwinTable kTwinTable; \
  }
#define GRAZE_VARIANT(name, ...)    \
  GRAZE_DECLARE(twin_##name)        \
  GRAZE_DECLARE(policy_twin_##name) \
  GRAZE_DECLARE(record_twin_##name) \
  GRAZE_DECLARE(twin_##name##_portable)
#include "core/variants.inc"
#undef GRAZE_VARIANT

// The lane's row for this processor. The row of a lane without a twin has no functions.
const TwinRow& twin_row(const Lane& lane);

}  // namespace graze::cuda
