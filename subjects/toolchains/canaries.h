// SPDX-License-Identifier: Apache-2.0
// Canaries: small computations whose bits show what a toolchain does with floating-point code (canaries.c). They are
// judged by these bits alone, never by what a flag says.
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
  std::string code;                  // what it computes: "t = a*b; t + c"
  std::vector<std::uint64_t> bits;   // its results; empty without an answer
  std::string found;                 // "as written", "fused"
  std::optional<Rounding> rounding;  // the least that explains the bits; nothing without an answer
};

// The results of all canaries, for float and then for double.
// output: what the program printed, which is not trusted. A line that is missing, occurs twice, or does not have
// as many numbers as expected, is not an answer.
std::vector<CanaryResult> judge_canaries(std::string_view output);

// What all canaries together show; nothing if one has no answer. Omits fma(), which belongs to the library.
std::optional<Rounding> measured_rounding(const std::vector<CanaryResult>& results);

// Whether a result is what the documentation says; no_claim: it leaves several results open.
enum class Documented { holds, does_not_hold, no_claim };
Documented compared(const CanaryResult& result, const Claim& claim);
std::string_view name(Documented documented);

}  // namespace graze::subjects
