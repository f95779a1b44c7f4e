// SPDX-License-Identifier: Apache-2.0
// The truth of a pair as its numbers were typed, before they were rounded to float32.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/pair.h"
#include "oracle/truth.h"

namespace graze::oracle {

// Which of a pair's numbers float32 cannot hold as written. Float32 can hold infinities and NaN.
// Requires: 18 texts; the pair's coordinates are their nearest float32 (core/text.h).
// Throws: std::runtime_error for an exponent of more than five digits.
std::vector<std::size_t> rounded(std::span<const std::string> numbers, const Pair& stored);

// Verdict, contact and margin of the numbers as rationals, decided like truth(). Ulps are those of the stored pair.
// Nothing if every number is stored as written, or if a number is not finite.
// Exact: always.   Throws: OracleMismatch; what rounded throws.
std::optional<Truth> truth_as_written(std::span<const std::string> numbers, const Pair& stored);

}  // namespace graze::oracle
