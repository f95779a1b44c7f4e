// SPDX-License-Identifier: Apache-2.0
// The twins' functions, a table a build variant: [algorithm][scalar]. The contracted kernels are compiled twice, for
// processors with and without FMA instructions; the verdicts are the same, the time is not.
#pragma once

#include <array>

#include "core/algorithms/algorithms.h"
#include "cuda/twin/twin.h"

namespace graze::cuda {

struct TwinRow {
  DecideBlock decide = nullptr;
  TraceBlock trace = nullptr;
  Verdict (*decide_fusing)(const Pair& pair, const std::uint64_t* fused) = nullptr;
  const char* hash = "";
  const char* trace_hash = "";
  const char* symbol = "";  // of the kernel that it replays
  const char* trace_symbol = "";
  std::span<const ContractionSite> sites = {};
};

struct TwinTable {
  const char* toolkit;
  std::array<std::array<TwinRow, 2>, kAlgorithmCount> rows;
};
extern const TwinTable kTwinsFma, kTwinsFmaPortable, kTwinsNofma;

// A lane's row for this processor; one without functions where there is no twin.
const TwinRow& twin_row(int algorithm, Scalar scalar, Target target);

}  // namespace graze::cuda
