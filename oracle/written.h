// SPDX-License-Identifier: Apache-2.0
// What a pair is as it was typed, before its numbers were rounded to float32.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/pair.h"
#include "oracle/truth.h"

namespace graze::oracle {

// The first of a pair's numbers that float32 does not hold as it is written, if any; infinities and NaN it holds.
// Requires: 18 texts of which the pair's coordinates are the nearest float32 (core/text.h).
// Throws: std::runtime_error for an exponent of more than five digits.
std::optional<std::size_t> first_rounded(std::span<const std::string> numbers, const Pair& stored);

// Verdict, contact and margin of the numbers as rationals, decided as truth() does; the margin in ulps is in those of
// the stored pair. Nothing where every number is stored as written, or one is not finite.
// Exact: always.   Throws: OracleMismatch; and as first_rounded.
std::optional<Truth> truth_as_written(std::span<const std::string> numbers, const Pair& stored);

}  // namespace graze::oracle
