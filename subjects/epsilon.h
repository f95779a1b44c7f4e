// SPDX-License-Identifier: Apache-2.0
// The epsilon in a user's source: a constant such as kEps, or a small number such as 1e-6f. These functions find the
// epsilon in the text, and replace its value. The text may be anything, and is read once, from front to back.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace graze::subjects {

// Determines the syntax of the cast to the old value's type. cpp: C++ and CUDA.
enum class SourceLanguage { c, cpp };

// The bytes [begin, end) of a source, and their line number, from 1.
struct SourcePlace {
  std::size_t begin, end;
  int line;
};

struct Epsilon {
  std::string name;                 // the constant's name, or a bare number's text
  std::string written;              // its value as written: "1e-6f", "4 * FLT_EPSILON"
  std::optional<double> value;      // nothing if the text is not a number
  std::vector<SourcePlace> places;  // of the value; at least one
};

// The constants that have a value, and the bare numbers between 0 and 1e-3: each once, in the order of their first
// places.   Throws: std::runtime_error for a text of more than 1 MiB.
std::vector<Epsilon> epsilons_in(std::string_view text);

// The first six different texts among numbers above 0 and up to 0.1, FLT_EPSILON, DBL_EPSILON and
// std::numeric_limits<…>::epsilon(), each with all its places.   Throws: as epsilons_in.
std::vector<Epsilon> small_numbers_in(std::string_view text);

// The epsilon with this name. Without a name, the only constant whose name contains eps or tol, or else the only small
// number.   Throws: UsageError that lists the candidates, or says how to name the constant.
Epsilon epsilon_of(const std::filesystem::path& source, std::string_view text, const std::string& name);

// The text with this value at each place of the epsilons. The new value has the same type as the old one.
std::string with_value(std::string_view text, const std::vector<Epsilon>& epsilons, double value,
                       SourceLanguage language);

// The value in the source's notation: "3.05e-05f".
std::string written_value(const Epsilon& epsilon, double value);

// "mine.cpp:9", "mine.cpp:9 and 12"; printable.
std::string places_in_words(const std::filesystem::path& source, const Epsilon& epsilon);

}  // namespace graze::subjects
