// SPDX-License-Identifier: Apache-2.0
// The minimiser spends most of its time here: for every pair that a move makes, it asks whether it is simpler.
#include "core/simplify/simplicity.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

namespace graze {
namespace {

// Bits of each count. There are at most 18 coordinates of 24 bits, an exponent's distance of 149 each, and 6 vertices.
constexpr int kWidths[] = {5, 5, 5, 9, 12, 3, 2, 5};

constexpr int bits_below(int criterion) {
  int bits = 0;
  for (int later = criterion; later < 8; ++later) bits += kWidths[later];
  return bits;
}

std::uint32_t rank(float value) { return std::rotl(std::bit_cast<std::uint32_t>(value), 1); }

// The number of distinct vertices; -0 and 0 are the same.
unsigned different_vertices(const Pair& pair) {
  const Vec3<float>* v = pair.a;  // the six vertices, one after the other
  unsigned different = 0;
  for (int i = 0; i < 6; ++i) different += std::find(v, v + i, v[i]) == v + i;
  return different;
}

unsigned plane_of_first(const Pair& pair) {
  const auto flat = [&](int axis) {
    return std::all_of(pair.a, pair.a + 3, [axis](const Vec3<float>& p) { return component(p, axis) == 0; });
  };
  return flat(2) ? 0 : flat(0) || flat(1) ? 1 : 2;
}

}  // namespace

std::uint64_t simplicity_counts(const Pair& pair, std::uint64_t most) {
  constexpr std::uint32_t kOne = 0x3f800000u, kMagnitude = 0x7fffffffu;
  const float* c = coordinates(pair);
  // The values other than 0, and those other than 0 and 1, packed at the front.
  std::uint32_t nonzero[kCoordinates], others[kCoordinates];
  unsigned nonzeros = 0, other = 0, signs = 0, unwieldy = 0;
  for (int i = 0; i < kCoordinates; ++i) {
    const auto bits = std::bit_cast<std::uint32_t>(c[i]);
    const std::uint32_t magnitude = bits & kMagnitude;
    signs += bits >> 31;
    nonzero[nonzeros] = magnitude;
    nonzeros += magnitude != 0;
    others[other] = magnitude;
    other += magnitude != 0 && magnitude != kOne;
    const float small = std::fabs(c[i]) < 1000 ? c[i] : 0.5f;
    unwieldy += static_cast<float>(static_cast<int>(small)) != small;
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
    const std::uint32_t biased = nonzero[i] >> 23;
    const std::uint32_t mantissa = (nonzero[i] & 0x7fffffu) | (biased ? 0x800000u : 0u);
    const int width = std::bit_width(mantissa);
    mantissa_bits += static_cast<unsigned>(width - std::countr_zero(mantissa));
    exponents += static_cast<unsigned>(std::abs(static_cast<int>(std::max(biased, 1u)) - 127 - 24 + width));
  }
  counts = (counts << kWidths[3] | mantissa_bits) << kWidths[4] | exponents;
  if (above(5)) return ~std::uint64_t{0};
  counts = (counts << kWidths[5] | different_vertices(pair)) << kWidths[6] | plane_of_first(pair);
  return counts << kWidths[7] | signs;
}

Simplicity simplicity(const Pair& pair) {
  Simplicity s{simplicity_counts(pair), {}};
  std::transform(coordinates(pair), coordinates(pair) + kCoordinates, s.ranks.begin(), rank);
  return s;
}

int count_of(const Simplicity& simplicity, int criterion) {
  return static_cast<int>(simplicity.counts >> bits_below(criterion) & ((1u << kWidths[criterion - 1]) - 1));
}

bool simpler_coordinates(const Pair& l, const Pair& r) {
  const float *x = coordinates(l), *y = coordinates(r);
  const auto [at, other] = std::mismatch(x, x + kCoordinates, y, [](float p, float q) { return rank(p) == rank(q); });
  return at != x + kCoordinates && rank(*at) < rank(*other);
}

}  // namespace graze
