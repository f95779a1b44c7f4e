// SPDX-License-Identifier: Apache-2.0
// The twins' functions, one table for each variant with a twin, in a namespace of its own: [algorithm][scalar]. The
// contracted kernels are compiled twice, for processors with and without FMA instructions; the verdicts are the same,
// the time is not.
#pragma once

#include <array>

#include "core/algorithms/algorithms.h"
#include "cuda/twin/twin.h"

namespace graze::cuda {

struct TwinRow {
  DecideBlock::Function decide = nullptr;
  TraceBlock trace = nullptr;
  Verdict (*decide_fusing)(const Pair& pair, const std::uint64_t* fused) = nullptr;
  const char* hash = "";
  const char* trace_hash = "";
  const char* symbol = "";  // of the kernel that it replays
  const char* trace_symbol = "";
  std::span<const ContractionSite> sites = {};
  DecideBlock::Within absolute = nullptr, relative = nullptr;  // under tolerances, without relative ones or with
};

struct TwinTable {
  const char* toolkit;
  std::array<std::array<TwinRow, 2>, kAlgorithmCount> rows;
};

// twin_NAME of the variants with a twin, and twin_NAME_portable of those with contraction; policy_twin_NAME, of
// lanes under tolerances, for all processors.
#define GRAZE_DECLARE(name)          \
  namespace name {                   \
  extern const TwinTable kTwinTable; \
  }
#define GRAZE_DECLARE_no_twin_rounded(name)
#define GRAZE_DECLARE_no_twin_contracted(name)
#define GRAZE_DECLARE_no_twin_fast(name)
#define GRAZE_DECLARE_no_twin_flushed(name)
#define GRAZE_DECLARE_no_twin_exact(name)
#define GRAZE_DECLARE_twin_rounded(name) GRAZE_DECLARE(twin_##name) GRAZE_DECLARE(policy_twin_##name)
#define GRAZE_DECLARE_twin_contracted(name) \
  GRAZE_DECLARE(twin_##name) GRAZE_DECLARE(twin_##name##_portable) GRAZE_DECLARE(policy_twin_##name)
#define GRAZE_VARIANT(name, id, runs_on, arithmetic, twin, ...) GRAZE_DECLARE_##twin##_##arithmetic(name)
#include "core/variants.inc"
#undef GRAZE_VARIANT

// A lane's row for this processor; one without functions where there is no twin.
const TwinRow& twin_row(const Lane& lane);

}  // namespace graze::cuda
