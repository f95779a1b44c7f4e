// SPDX-License-Identifier: Apache-2.0
// More PTX operations on the CPU, on integers' bits, bit fields and bytes.
#pragma once

#include "cuda/twin/twin_ops_logic.h"

namespace graze::cuda {
inline namespace GRAZE_FP {
namespace ptx {

template <class T>
u32 popc(T x) {
  return static_cast<u32>(std::popcount(x));
}

template <class T>
u32 clz(T x) {
  return static_cast<u32>(std::countl_zero(x));
}

template <class T>
T brev(T x) {
  T result = 0;
  for (unsigned bit = 0; bit < 8 * sizeof(T); ++bit) result = static_cast<T>(result << 1 | (x >> bit & 1));
  return result;
}

// The index of the highest set bit, or of the highest clear bit of a negative number; all ones without such a bit.
template <class T>
u32 bfind(T x) {
  const Bits<T> bits = static_cast<Bits<T>>(x < 0 ? ~x : x);
  return bits == 0 ? ~u32{0} : static_cast<u32>(8 * sizeof(T)) - 1 - clz(bits);
}

// .shiftamt: the left shift that moves this bit to the top position.
template <class T>
u32 bfind_shift(T x) {
  const u32 place = bfind(x);
  return place == ~u32{0} ? place : static_cast<u32>(8 * sizeof(T)) - 1 - place;
}

// A bit field's position or size. For 32-bit values, only the low byte counts. For 64-bit values, all 32 bits count, as
// measured on a device.
template <class T>
u64 field(u32 number) {
  return sizeof(T) == 4 ? number & 0xff : number;
}

// Bits [at, at + count) of the value. Signed types are sign-extended from the field's highest bit, or from the value's
// highest bit if the field exceeds the value.
template <class T>
T bfe(T x, u32 from, u32 size) {
  constexpr u32 kMost = 8 * sizeof(T) - 1;
  const u64 at = field<T>(from), count = field<T>(size);
  const u64 top = at + count - 1 < kMost ? at + count - 1 : kMost;  // not used if count is 0
  const Bits<T> bits = static_cast<Bits<T>>(x), sign = std::is_unsigned_v<T> || count == 0 ? 0 : bits >> top & 1;
  Bits<T> result = 0;
  for (u32 k = 0; k <= kMost; ++k) {
    const Bits<T> bit = k < count && at + k <= kMost ? bits >> (at + k) & 1 : sign;
    result = static_cast<Bits<T>>(result | bit << k);
  }
  return static_cast<T>(result);
}

// Returns b with bits [at, at + count) replaced by the low bits of a.
template <class T>
T bfi(T a, T b, u32 from, u32 size) {
  const u64 at = field<T>(from), count = field<T>(size);
  for (u32 k = 0; k < count && at + k < 8 * sizeof(T); ++k) {
    const T bit = static_cast<T>(T{1} << (at + k));
    b = static_cast<T>((b & ~bit) | ((a >> k & 1) << (at + k)));
  }
  return b;
}

// Selects four of the eight bytes of (b, a). Four bits select each byte; the highest requests copies of its sign bit.
inline u32 prmt(u32 a, u32 b, u32 choice) {
  const u64 all = u64{b} << 32 | a;
  u32 result = 0;
  for (u32 k = 0; k < 4; ++k) {
    const u32 select = choice >> (4 * k) & 15;
    u32 byte = static_cast<u32>(all >> (8 * (select & 7))) & 0xff;
    if (select & 8) byte = byte & 0x80 ? 0xff : 0;
    result |= byte << (8 * k);
  }
  return result;
}

// The shift amount of shf: modulo 32 (wrap), or at most 32 (clamp).
inline u32 wrap(u32 by) { return by & 31; }
inline u32 clamp(u32 by) { return by < 32 ? by : 32; }

// Shifts (b, a) and returns the upper half after a left shift, or the lower half after a right shift.
inline u32 shf_l(u32 a, u32 b, u32 by) { return static_cast<u32>((u64{b} << 32 | a) << by >> 32); }
inline u32 shf_r(u32 a, u32 b, u32 by) { return static_cast<u32>((u64{b} << 32 | a) >> by); }

// Each bit of the result is a bit of the table, indexed by the three operands' bits at that position.
inline u32 lop3(u32 a, u32 b, u32 c, u32 table) {
  u32 result = 0;
  for (u32 k = 0; k < 8; ++k) {
    if (table >> k & 1) result |= (k & 4 ? a : ~a) & (k & 2 ? b : ~b) & (k & 1 ? c : ~c);
  }
  return result;
}

}  // namespace ptx
}  // namespace GRAZE_FP
}  // namespace graze::cuda
