// SPDX-License-Identifier: Apache-2.0
// The minimiser spends most of its time here, because it compares the result of every move with the current pair.
#include "core/simplify/simplicity.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace graze {
namespace {

// Bits of each count. A pair has at most 18 coordinates of 53 bits, with exponents at most 1074 from 0, and 6 vertices.
constexpr int kWidths[] = {5, 5, 5, 10, 15, 3, 2, 5};

constexpr int bits_below(int criterion) {
  int bits = 0;
  for (int later = criterion; later < 8; ++later) bits += kWidths[later];
  return bits;
}

template <class Real>
BitsOf<Real> rank(Real value) {
  return std::rotl(std::bit_cast<BitsOf<Real>>(value), 1);
}

// The number of distinct vertices; -0 equals 0.
template <class Real>
unsigned different_vertices(const BasicPair<Real>& pair) {
  const Vec3<Real>* v = pair.a;  // the six vertices, one after the other
  unsigned different = 0;
  for (int i = 0; i < 6; ++i) different += std::find(v, v + i, v[i]) == v + i;
  return different;
}

template <class Real>
unsigned plane_of_first(const BasicPair<Real>& pair) {
  const auto flat = [&](int axis) {
    return std::all_of(pair.a, pair.a + 3, [axis](const Vec3<Real>& p) { return component(p, axis) == 0; });
  };
  return flat(2) ? 0 : flat(0) || flat(1) ? 1 : 2;
}

}  // namespace

template <class Real>
std::uint64_t simplicity_counts(const BasicPair<Real>& pair, std::uint64_t most) {
  using Bits = BitsOf<Real>;
  constexpr int kDigits = std::numeric_limits<Real>::digits, kBias = std::numeric_limits<Real>::max_exponent - 1;
  constexpr Bits kOne = std::bit_cast<Bits>(Real{1}), kHidden = Bits{1} << (kDigits - 1),
                 kMagnitude = static_cast<Bits>(~Bits{0} >> 1);
  const Real* c = coordinates(pair);
  // `nonzero` begins with the magnitudes other than 0, and `others` with those other than 0 and 1.
  Bits nonzero[kCoordinates], others[kCoordinates];
  unsigned nonzeros = 0, other = 0, signs = 0, unwieldy = 0;
  for (int i = 0; i < kCoordinates; ++i) {
    const auto bits = std::bit_cast<Bits>(c[i]);
    const Bits magnitude = bits & kMagnitude;
    signs += static_cast<unsigned>(bits >> (8 * sizeof(Bits) - 1));
    nonzero[nonzeros] = magnitude;
    nonzeros += magnitude != 0;
    others[other] = magnitude;
    other += magnitude != 0 && magnitude != kOne;
    const Real small = std::fabs(c[i]) < 1000 ? c[i] : Real{0.5};
    unwieldy += static_cast<Real>(static_cast<int>(small)) != small;
  }
  unsigned magnitudes = 0;
  for (unsigned i = 0; i < other; ++i) {
    bool seen = false;
    for (unsigned j = 0; j < i; ++j) seen |= others[j] == others[i];
    magnitudes += !seen;
  }
  std::uint64_t counts = (std::uint64_t{magnitudes} << kWidths[1] | nonzeros) << kWidths[2] | unwieldy;
  const auto above = [&](int criteria) { return counts > most >> bits_below(criteria); };
  if (above(3)) return ~std::uint64_t{0};
  unsigned mantissa_bits = 0, exponents = 0;
  for (unsigned i = 0; i < nonzeros; ++i) {
    const auto biased = static_cast<unsigned>(nonzero[i] >> (kDigits - 1));
    const Bits mantissa = (nonzero[i] & (kHidden - 1)) | (biased ? kHidden : 0u);
    const auto width = static_cast<int>(std::bit_width(mantissa));
    mantissa_bits += static_cast<unsigned>(width - std::countr_zero(mantissa));
    exponents += static_cast<unsigned>(std::abs(static_cast<int>(std::max(biased, 1u)) - kBias - kDigits + width));
  }
  counts = (counts << kWidths[3] | mantissa_bits) << kWidths[4] | exponents;
  if (above(5)) return ~std::uint64_t{0};
  counts = (counts << kWidths[5] | different_vertices(pair)) << kWidths[6] | plane_of_first(pair);
  return counts << kWidths[7] | signs;
}

template <class Real>
Simplicity simplicity(const BasicPair<Real>& pair) {
  Simplicity s{simplicity_counts(pair), {}};
  std::transform(coordinates(pair), coordinates(pair) + kCoordinates, s.ranks.begin(),
                 [](Real x) { return rank(static_cast<double>(x)); });
  return s;
}

int count_of(const Simplicity& simplicity, int criterion) {
  return static_cast<int>(simplicity.counts >> bits_below(criterion) & ((1u << kWidths[criterion - 1]) - 1));
}

template <class Real>
bool simpler_coordinates(const BasicPair<Real>& l, const BasicPair<Real>& r) {
  const Real *x = coordinates(l), *y = coordinates(r);
  const auto [at, other] = std::mismatch(x, x + kCoordinates, y, [](Real p, Real q) { return rank(p) == rank(q); });
  return at != x + kCoordinates && rank(*at) < rank(*other);
}

template Simplicity simplicity(const Pair&);
template Simplicity simplicity(const DoublePair&);
template std::uint64_t simplicity_counts(const Pair&, std::uint64_t);
template std::uint64_t simplicity_counts(const DoublePair&, std::uint64_t);
template bool simpler_coordinates(const Pair&, const Pair&);
template bool simpler_coordinates(const DoublePair&, const DoublePair&);

}  // namespace graze
