// SPDX-License-Identifier: Apache-2.0
// For all readers: parses numbers with one rounding, rejects text that is not a number, and makes text printable.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace graze {

// Returns: the float32 nearest to the number in `text`, ties to even, rounded once. Returns nothing if `text` is not
// entirely a number, or if it rounds beyond the largest float32. "inf" and "nan" are numbers.
std::optional<float> parse_float32(std::string_view text);
// The same for doubles.
std::optional<double> parse_float64(std::string_view text);

// Returns: the whole number in `text`, without a sign; nothing if `text` is not such a number or is too large.
std::optional<std::uint64_t> parse_whole(std::string_view text);

// rounded_up returns the smallest decimal with `digits` significant digits that is not below the value; rounded_down
// returns the largest that is not above it. The format is that of %g: 0.02032 gives "0.021" and "0.02". They are for
// printed upper and lower bounds, which rounding to nearest could make false. Requires: a finite value, 1 to 15 digits.
std::string rounded_up(double value, int digits);
std::string rounded_down(double value, int digits);

// Returns: the text, with \xHH for each byte that is not printable ASCII.
std::string printable(std::string_view text);

// Returns: the text in quotes. Quotes and backslashes get a backslash; other bytes are as in printable().
std::string in_quotes(std::string_view text);

// Like in_quotes, but cut for messages: `shown` cuts after 40 bytes, `shown_path` after 400.
std::string shown(std::string_view text);
std::string shown_path(std::string_view path);

// Returns: the word as a shell reads it, quoted if necessary.
std::string shell_word(std::string_view word);

// Returns: the path as a shell word that no program mistakes for an option: "./-x" for "-x".
std::string path_word(std::string_view path);

// Returns: "; did you mean 'moller_1997/f32/cpu'?" with the candidate that is the fewest edits away from `found`; empty
// if none is close. A * in `found` stands for any text.
std::string did_you_mean(std::string_view found, const std::vector<std::string>& candidates);

}  // namespace graze
