// SPDX-License-Identifier: Apache-2.0
// The truth of a pair's numbers as they were typed, before they are rounded to float32.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/pair.h"
#include "oracle/truth.h"

namespace graze::oracle {

// Indices of the pair's numbers that float32 cannot hold as written. Float32 can hold infinities and NaN.
// Requires: 18 texts; `stored` has their nearest float32 values (core/text.h).
// Throws: std::runtime_error for an exponent of more than five digits.
std::vector<std::size_t> rounded(std::span<const std::string> numbers, const Pair& stored);

// Verdict, contact and margin of the numbers as rationals, decided like truth(). Ulps are those of the stored pair.
// Returns: nothing if every number is stored as written, or if a number is not finite.
// Exact: always.   Throws: OracleMismatch; the errors of rounded.
std::optional<Truth> truth_as_written(std::span<const std::string> numbers, const Pair& stored);

}  // namespace graze::oracle
