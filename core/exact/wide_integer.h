// SPDX-License-Identifier: Apache-2.0
// Integers of a fixed number of 64-bit limbs, for host and device, and the compiler's 128-bit integer.
#pragma once

#include <cstdint>

#include "core/exact/host_device.h"

namespace graze::exact::detail {

using Int128 = __int128;

// Two's complement integers of N 64-bit limbs, lowest first. Each user picks N large enough, so nothing overflows.
template <int N>
struct Wide {
  std::uint64_t limb[N];

  GRAZE_HD Wide() : limb{} {}
  GRAZE_HD explicit Wide(int zero) : limb{} { limb[0] = static_cast<std::uint64_t>(zero); }
  template <int K>
  GRAZE_HD explicit Wide(const Wide<K>& x) {
    for (int i = 0; i < N; ++i) limb[i] = i < K ? x.limb[i] : x.negative() ? ~std::uint64_t{0} : 0;
  }

  GRAZE_HD explicit Wide(Int128 x) : limb{} {
    for (int i = 0; i < N; ++i) {
      limb[i] = static_cast<std::uint64_t>(x);
      x >>= 64;
    }
  }

  GRAZE_HD bool negative() const { return limb[N - 1] >> 63 != 0; }

  GRAZE_HD Wide operator-() const { return Wide(0) - *this; }

  GRAZE_HD friend Wide operator+(const Wide& l, const Wide& r) {
    Wide sum;
    unsigned __int128 carry = 0;
    for (int i = 0; i < N; ++i) {
      carry += static_cast<unsigned __int128>(l.limb[i]) + r.limb[i];
      sum.limb[i] = static_cast<std::uint64_t>(carry);
      carry >>= 64;
    }
    return sum;
  }

  GRAZE_HD friend Wide operator-(const Wide& l, const Wide& r) {
    Wide difference;
    std::uint64_t borrow = 0;
    for (int i = 0; i < N; ++i) {
      const std::uint64_t part = l.limb[i] - r.limb[i];
      difference.limb[i] = part - borrow;
      borrow = (l.limb[i] < r.limb[i]) | (part < borrow);
    }
    return difference;
  }

  template <int K>
  GRAZE_HD GRAZE_CALLED friend Wide operator*(const Wide& l, const Wide<K>& r) {
    const bool turn = l.negative() != r.negative();
    const Wide u = l.negative() ? -l : l;
    const Wide<K> v = r.negative() ? -r : r;
    Wide product;
    for (int i = 0; i < N; ++i) {
      if (u.limb[i] == 0) continue;
      std::uint64_t carry = 0;
      for (int j = 0; i + j < N; ++j) {
        if (j >= K && carry == 0) break;
        const unsigned __int128 term =
            static_cast<unsigned __int128>(u.limb[i]) * (j < K ? v.limb[j] : 0) + product.limb[i + j] + carry;
        product.limb[i + j] = static_cast<std::uint64_t>(term);
        carry = static_cast<std::uint64_t>(term >> 64);
      }
    }
    return turn ? -product : product;
  }

  // Multiplies l and r as unsigned numbers. A negative r then counts as r + 2^64, so `less` is subtracted.
  GRAZE_HD friend Wide operator*(const Wide& l, std::int64_t r) {
    Wide product;
    std::uint64_t carry = 0, borrow = 0;
    const std::uint64_t correct = r < 0 ? ~std::uint64_t{0} : 0;
    for (int i = 0; i < N; ++i) {
      const unsigned __int128 term = static_cast<unsigned __int128>(l.limb[i]) * static_cast<std::uint64_t>(r) + carry;
      carry = static_cast<std::uint64_t>(term >> 64);
      const auto low = static_cast<std::uint64_t>(term);
      const std::uint64_t less = i > 0 ? l.limb[i - 1] & correct : 0, part = low - less;
      product.limb[i] = part - borrow;
      borrow = (low < less) | (part < borrow);
    }
    return product;
  }

  GRAZE_HD friend bool operator<(const Wide& l, const Wide& r) { return (l - r).negative(); }
  GRAZE_HD friend bool operator>(const Wide& l, const Wide& r) { return r < l; }
  GRAZE_HD friend bool operator==(const Wide& l, const Wide& r) {
    for (int i = 0; i < N; ++i) {
      if (l.limb[i] != r.limb[i]) return false;
    }
    return true;
  }
};

}  // namespace graze::exact::detail
