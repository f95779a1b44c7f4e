// SPDX-License-Identifier: Apache-2.0
// The twins' functions: a table [algorithm][scalar] for each variant with a twin, each in its own namespace. Contracted
// kernels are compiled twice, for processors with and without FMA instructions. Both compilations give the same
// verdicts at different speeds.
#pragma once

#include <array>

#include "core/algorithms/algorithms.h"
#include "cuda/twin/twin.h"

namespace graze::cuda {

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

}  // namespace graze::cuda
