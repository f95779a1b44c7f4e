// SPDX-License-Identifier: Apache-2.0
// What every reader needs: numbers from text, in full or not at all, rounded once; and foreign text made fit to print.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace graze {

// Returns: the float32 nearest to the number that text spells, ties to even, rounded once; nothing when text is
// not a number in full, or when its nearest is beyond the largest float32. "inf" and "nan" are numbers.
std::optional<float> parse_float32(std::string_view text);

// Returns: the whole number that text spells, without a sign; nothing when it spells none or one too large.
std::optional<std::uint64_t> parse_whole(std::string_view text);

// Returns: the least decimal of so many significant digits that is not below the value, and the greatest that is not
// above it, as %g writes them: 0.02032 is "0.021" and "0.02". For upper and lower bounds, which rounding to the nearest
// would make false.   Requires: a finite value, 1 to 15 digits.
std::string rounded_up(double value, int digits);
std::string rounded_down(double value, int digits);

// Returns: the text with each byte that is not printable ASCII as \xHH, so that it can be printed anywhere.
std::string printable(std::string_view text);

// Returns: the text in quotes, quotes and backslashes behind a backslash, other bytes as printable() shows them.
std::string in_quotes(std::string_view text);

// in_quotes, cut short for a message. The file's path is cut only where no person would read on.
std::string shown(std::string_view text);
std::string shown_path(std::string_view path);

// Returns: the word as a shell reads it back; quoted where it has to be.
std::string shell_word(std::string_view word);

// Returns: "; did you mean 'moller_1997/f32/cpu'?" of the candidate that is least edits away from what was found, in
// which * stands for anything; empty when none is near.
std::string did_you_mean(std::string_view found, const std::vector<std::string>& candidates);

}  // namespace graze
