// SPDX-License-Identifier: Apache-2.0
// Canaries: small computations whose bits show how a toolchain treats floating-point code (canaries.c). These functions
// judge a canary by its bits alone, never by flags.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "subjects/toolchains/claim.h"
#include "subjects/toolchains/toolchains.h"

namespace graze::subjects {

struct CanaryResult {
  std::string name, scalar;          // "statements", "f32"
  std::string code;                  // the computation: "t = a*b; t + c"
  std::vector<std::uint64_t> bits;   // bits of the results; empty without an answer
  std::string found;                 // the judgement: "as written", "fused"
  std::optional<Rounding> rounding;  // the strictest rounding that explains the bits; nothing without an answer
};

// The results of all canaries, for float and then for double.
// output: the canaries' program's output, which is not trusted. A canary has no answer if its line is missing, occurs
// twice, or does not have the expected number of results.
std::vector<CanaryResult> judge_canaries(std::string_view output);

// The strictest rounding that explains all canaries; nothing if one has no answer. Ignores the canary `fma`, because
// fma() is a library function.
std::optional<Rounding> measured_rounding(const std::vector<CanaryResult>& results);

// Whether a result is as documented. no_claim: the documentation permits several results.
enum class Documented { holds, does_not_hold, no_claim };
Documented compared(const CanaryResult& result, const Claim& claim);
std::string_view name(Documented documented);

}  // namespace graze::subjects
