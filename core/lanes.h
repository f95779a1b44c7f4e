// SPDX-License-Identifier: Apache-2.0
// The lane table: one row for each way to decide a pair, `algorithm/scalar/target`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/algorithms/algorithm.h"
#include "core/pair.h"

namespace graze {

enum class Scalar : std::uint8_t { f32, f64 };

// cpu: no contraction. cpu_fma: the host compiler's contraction. cuda_nofma: -fmad=false. cuda_fma: nvcc's default.
// cuda: exact lanes only, whose verdicts do not depend on contraction.
enum class Target : std::uint8_t { cpu, cpu_fma, cuda_nofma, cuda_fma, cuda };
inline constexpr int kTargetCount = 4;  // of every published algorithm; exact lanes have cpu and cuda

std::string_view name(Scalar scalar);
std::string_view name(Target target);

// Decides pairs[0..count): bit i % 64 of word i / 64 says intersects, or declined. Unused bits become zero.
// Requires: room for (count + 63) / 64 words in both.
using DecideBlock = void (*)(const Pair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined);

// What a pair's two bits say.
constexpr Verdict verdict_of_bits(bool intersects, bool declined) {
  return declined ? Verdict::declined : intersects ? Verdict::intersects : Verdict::disjoint;
}

// The block's verdict on one pair.
Verdict decide_one(DecideBlock block, const Pair& pair);

struct Lane {
  int index;  // place in lanes()
  std::string id;
  const AlgorithmInfo* info;
  int algorithm;  // place in Algorithms; behind its end for exact lanes
  Scalar scalar;
  Target target;
  DecideBlock decide;  // null for CUDA lanes; see cuda/lanes/device.h

  bool is_cuda() const { return target != Target::cpu && target != Target::cpu_fma; }
  bool is_exact() const;  // right on every finite pair, and declines the others; see core/exact/exact.h
};

// All lanes, ordered by algorithm, scalar, target; the exact ones last.
std::span<const Lane> lanes();

// Those of published algorithms, which can be wrong: all but the exact ones.
std::span<const Lane> published_lanes();

// Whether this processor can run the host lane (cpu-fma needs FMA instructions).
bool runs_on_this_cpu(const Lane& lane);

// Whether any of the shell patterns (fnmatch) matches; an empty list matches everything.
bool matches_any(const std::vector<std::string>& globs, std::string_view id);

}  // namespace graze
