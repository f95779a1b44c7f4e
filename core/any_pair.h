// SPDX-License-Identifier: Apache-2.0
// A pair of either coordinate type.
#pragma once

#include <optional>
#include <utility>

#include "core/pair.h"

namespace graze {

// Holds the coordinates as doubles, without rounding. A float32 pair also keeps its floats, for the lanes.
struct AnyPair {
  DoublePair doubles;
  std::optional<Pair> floats;

  AnyPair(const Pair& pair) : doubles(in_doubles(pair)), floats(pair) {}
  AnyPair(const DoublePair& pair) : doubles(pair) {}

  // The pair in float32. Doubles are rounded, as by a program that stores coordinates as float32.
  Pair in_float32() const { return floats ? *floats : stored_in_float32(doubles); }
};

// Calls f with the pair in its own coordinate type.
template <class F>
decltype(auto) visit(const AnyPair& pair, F&& f) {
  return pair.floats ? std::forward<F>(f)(*pair.floats) : std::forward<F>(f)(pair.doubles);
}

}  // namespace graze
