// SPDX-License-Identifier: Apache-2.0
// std::from_chars for floating-point numbers, which libc++ 14 lacks. The compiler includes this header before all
// others. The functions call strtod and strtof of wasi-libc, which round once.
#pragma once

#include <charconv>
#include <cstdlib>
#include <string>

namespace std {

template <class Real>
from_chars_result from_chars_by(Real (*parse)(const char*, char**), const char* first, const char* last, Real& x,
                                chars_format format) {
  const string text = (format == chars_format::hex ? "0x" : "") + string(first, last);
  char* end = nullptr;
  x = parse(text.c_str(), &end);
  const ptrdiff_t read = end - text.c_str() - (format == chars_format::hex ? 2 : 0);
  if (read <= 0) return {first, errc::invalid_argument};
  const bool too_large = x * 0 != 0 && *first != 'i' && *first != 'I' && *first != 'n' && *first != 'N';
  return {first + read, too_large ? errc::result_out_of_range : errc()};
}

inline from_chars_result from_chars(const char* first, const char* last, double& x,
                                    chars_format format = chars_format::general) {
  return from_chars_by<double>(strtod, first, last, x, format);
}

inline from_chars_result from_chars(const char* first, const char* last, float& x,
                                    chars_format format = chars_format::general) {
  return from_chars_by<float>(strtof, first, last, x, format);
}

}  // namespace std
