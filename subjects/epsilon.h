// SPDX-License-Identifier: Apache-2.0
// The epsilon of a user's source: a constant such as kEps, or a small number such as 1e-6f. Finds it in the text, and
// writes the text with another value. The text may be anything: it is read once, from front to back.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace graze::subjects {

// Decides how a value is cast to its former type. cpp: also CUDA.
enum class SourceLanguage { c, cpp };

// The bytes [begin, end) of a source, in a line counted from 1.
struct SourcePlace {
  std::size_t begin, end;
  int line;
};

struct Epsilon {
  std::string name;                 // the constant's name; for a bare number, the number as it is written
  std::string written;              // its value in the source: "1e-6f", "4 * FLT_EPSILON"
  std::optional<double> value;      // if it is a number
  std::vector<SourcePlace> places;  // at least one: where the value stands
};

// The constants with a value, and the bare numbers between 0 and 1e-3, each once, in order of their first place.
// Throws: std::runtime_error for a text of more than 1 MiB.
std::vector<Epsilon> epsilons_in(std::string_view text);

// The numbers above 0 and up to 0.1, FLT_EPSILON, DBL_EPSILON and std::numeric_limits<…>::epsilon(), as they are
// written: each once, at all its places, the first six.   Throws: as epsilons_in.
std::vector<Epsilon> small_numbers_in(std::string_view text);

// The epsilon of that name or, for an empty one, the obvious one: the only constant whose name contains eps or tol, or
// else the only small number.   Throws: UsageError that lists the candidates, or says how to name the constant.
Epsilon epsilon_of(const std::filesystem::path& source, std::string_view text, const std::string& name);

// The text with this value at each place of the epsilons, of the same type as before.
std::string with_value(std::string_view text, const std::vector<Epsilon>& epsilons, double value,
                       SourceLanguage language);

// The value as the source would write it: "3.05e-05f".
std::string written_value(const Epsilon& epsilon, double value);

// "mine.cpp:9", "mine.cpp:9 and 12"; printable.
std::string places_in_words(const std::filesystem::path& source, const Epsilon& epsilon);

}  // namespace graze::subjects
