// SPDX-License-Identifier: Apache-2.0
// A total order of pairs: simpler pairs are easier to read. The minimiser only moves to simpler pairs, so it ends.
#pragma once

#include <array>
#include <compare>
#include <cstdint>

#include "core/any_pair.h"

namespace graze {

// The first criterion that differs decides: the pair with the smaller value is simpler.
//   1. different magnitudes other than 0 and 1
//   2. coordinates that are not zero
//   3. coordinates that are not whole numbers below 1000
//   4. bits of the mantissas, from the first set bit to the last, summed over all coordinates
//   5. distances of the exponents from 0, summed over all coordinates
//   6. different vertices
//   7. 0 if the first triangle lies in the plane z = 0, 1 if it lies in x = 0 or y = 0, else 2
//   8. minus signs, that of -0 included
//   9. the coordinates in order, by magnitude and then sign: two pairs are equal only if all their bits are equal.
struct Simplicity {
  std::uint64_t counts = 0;  // the eight counts, the first in the highest bits
  std::array<std::uint64_t, kCoordinates> ranks{};
  auto operator<=>(const Simplicity&) const = default;
};

// Pairs of floats and pairs of doubles share one order.   Requires: finite coordinates.
template <class Real>
Simplicity simplicity(const BasicPair<Real>& pair);

// Returns simplicity(pair).counts if that is at most `most`, otherwise some number above `most`, to save time.
// Requires: finite coordinates.
template <class Real>
std::uint64_t simplicity_counts(const BasicPair<Real>& pair, std::uint64_t most = ~std::uint64_t{0});

// The count of a criterion, 1 to 8.
int count_of(const Simplicity& simplicity, int criterion);

// Whether l comes before r by criterion 9 only, the order of the coordinates.
template <class Real>
bool simpler_coordinates(const BasicPair<Real>& l, const BasicPair<Real>& r);

inline Simplicity simplicity(const AnyPair& pair) { return simplicity(pair.doubles); }
inline bool is_simpler(const AnyPair& l, const AnyPair& r) { return simplicity(l) < simplicity(r); }

// The number of the pair's different magnitudes other than 0 and 1.
inline int nontrivial_magnitudes(const AnyPair& pair) { return count_of(simplicity(pair), 1); }

}  // namespace graze
