// SPDX-License-Identifier: Apache-2.0
// operator<=> for std::array, which libc++ 14 lacks. The compiler includes this header before all others.
#pragma once

#include <array>
#include <compare>
#include <cstddef>

namespace std {

template <class T, size_t N>
constexpr auto operator<=>(const array<T, N>& l, const array<T, N>& r) {
  for (size_t i = 0; i < N; ++i)
    if (const auto order = l[i] <=> r[i]; order != 0) return order;
  return T{} <=> T{};
}

}  // namespace std
