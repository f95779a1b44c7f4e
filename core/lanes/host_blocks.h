// SPDX-License-Identifier: Apache-2.0
// Tables [algorithm][scalar] of the host lanes' block functions, for each host variant in its own namespace.
#pragma once

#include <array>

#include "core/algorithms/algorithms.h"
#include "core/lanes/records.h"

namespace graze {

template <class Block>
using BlockTable = std::array<std::array<Block, 2>, kAlgorithmCount>;
using HostBlocks = BlockTable<DecideBlock::Function>;
using HostDoubleBlocks = std::array<DecideFunction<DoublePair>, kAlgorithmCount>;   // for lanes in double
using HostDoubleRecords = std::array<RecordFunction<DoublePair>, kAlgorithmCount>;  // for lanes in double

// The block functions of each kind of policy; null if the algorithm or the variant does not have the policy.
template <class AnyPair>
struct PolicyFunctions {
  DecideWithin<AnyPair> absolute = nullptr, relative = nullptr;  // `relative` also takes absolute tolerances
  DecideFunction<AnyPair> bound = nullptr;
};
using PolicyBlocks = PolicyFunctions<Pair>;
using HostPolicyBlocks = BlockTable<PolicyBlocks>;
using HostDoublePolicyBlocks = std::array<PolicyFunctions<DoublePair>, kAlgorithmCount>;

#define GRAZE_DECLARE_host(name)                               \
  namespace name {                                             \
  extern const HostBlocks kHostBlocks;                         \
  extern const HostDoubleBlocks kHostDoubleBlocks;             \
  extern const HostPolicyBlocks kHostPolicyBlocks;             \
  extern const HostDoublePolicyBlocks kHostDoublePolicyBlocks; \
  extern const BlockTable<RecordBlock> kHostRecords;           \
  extern const HostDoubleRecords kHostDoubleRecords;           \
  }
#define GRAZE_DECLARE_device(name)
#define GRAZE_DECLARE_program(name)
#define GRAZE_VARIANT(name, id, runs_on, ...) GRAZE_DECLARE_##runs_on(name)
#include "core/variants.inc"
#undef GRAZE_VARIANT
#undef GRAZE_DECLARE_host
#undef GRAZE_DECLARE_device
#undef GRAZE_DECLARE_program

}  // namespace graze
