// SPDX-License-Identifier: Apache-2.0
// Tests operations on integers and their bits, tables, scopes, calls and jumps (generator/semantics_bits.ptx).
#include "cuda/twin/twin_ops_bits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <tuple>
#include <vector>

#include "cuda/lanes/device.h"
#include "cuda/twin/ptx_testing.h"
#include "cuda/twin/twin.h"
#include "cuda/twin/twin_ops_rounding.h"

namespace graze::cuda {
inline namespace GRAZE_FP {
namespace ptx {
namespace {

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#include "cuda/generated/semantics_bits.inc"
#pragma GCC diagnostic pop

#include "cuda/twin/twin_ops_testing.inl"

using I = u32;

u64 pair_of(u32 low, u32 high) { return u64{high} << 32 | low; }
s32 sign(u32 x) { return static_cast<s32>(x); }
s64 sign(u64 x) { return static_cast<s64>(x); }

// The quotient or the remainder, computed in wide integers.
template <class T>
T divided(T a, T b, bool rest) {
  const __int128 x = a, y = b;
  return static_cast<T>(rest ? x % y : x / y);
}

// The bits of a field's position or size that count. For 64-bit numbers all bits count on an H200, though the PTX ISA
// does not state this.
template <class T>
s64 counted(u32 number) {
  return sizeof(T) == 4 ? number & 255 : number;
}

// The bit field, computed bit by bit according to the PTX ISA.
template <class T>
T field(T x, u32 at, u32 count) {
  const s64 most = 8 * sizeof(T) - 1, p = counted<T>(at), n = counted<T>(count);
  const auto bit = [&](s64 k) { return static_cast<u64>(x) >> k & 1; };
  const u64 fill = std::is_unsigned_v<T> || n == 0 ? 0 : bit(std::min(p + n - 1, most));
  u64 result = 0;
  for (s64 k = 0; k <= most; ++k) result |= (k < n && p + k <= most ? bit(p + k) : fill) << k;
  return static_cast<T>(result);
}

template <class T>
T inserted(T a, T b, u32 at, u32 count) {
  const s64 most = 8 * sizeof(T) - 1, p = counted<T>(at), n = counted<T>(count);
  for (s64 k = 0; k < n && p + k <= most; ++k) {
    b = static_cast<T>(b & ~(T{1} << (p + k)));
    b = static_cast<T>(b | (a >> k & 1) << (p + k));
  }
  return b;
}

template <class T>
u32 highest(T x) {
  for (int k = 8 * sizeof(T) - 1; k >= 0; --k) {
    if ((x >> k & 1) != (x < 0)) return static_cast<u32>(k);
  }
  return 0xffffffffu;
}

u32 byte(u32 x, u32 which) { return x >> (8 * which) & 0xff; }

u32 permuted(u32 a, u32 b, u32 choice) {
  u32 result = 0;
  for (u32 k = 0; k < 4; ++k) {
    const u32 select = choice >> (4 * k) & 15, from = select & 7;
    u32 one = from < 4 ? byte(a, from) : byte(b, from - 4);
    if (select & 8) one = one & 0x80 ? 0xff : 0;
    result |= one << (8 * k);
  }
  return result;
}

std::vector<Slot<I>> division() {
  const auto d = [](I a, I b, I c) { return std::pair(pair_of(a, b), pair_of(c, a) | 1); };
  return {slot<I>("div.s32", [](I a, I b, I) { return divided<s64>(sign(a), sign(b | 1), false) & 0xffffffff; }),
          slot<I>("div.u32", [](I a, I b, I) { return a / (b | 1); }),
          slot<I>("rem.s32", [](I a, I b, I) { return divided<s64>(sign(a), sign(b | 1), true) & 0xffffffff; }),
          slot<I>("rem.u32", [](I a, I b, I) { return a % (b | 1); }),
          slot<I>("div.s64",
                  [=](I a, I b, I c) { return divided<s64>(sign(d(a, b, c).first), sign(d(a, b, c).second), false); }),
          slot<I>("div.u64", [=](I a, I b, I c) { return d(a, b, c).first / d(a, b, c).second; }),
          slot<I>("rem.s64",
                  [=](I a, I b, I c) { return divided<s64>(sign(d(a, b, c).first), sign(d(a, b, c).second), true); }),
          slot<I>("rem.u64", [=](I a, I b, I c) { return d(a, b, c).first % d(a, b, c).second; }),
          slot<I>("mul.hi.s64",
                  [](I a, I b, I c) {
                    return static_cast<u64>(static_cast<__int128>(sign(pair_of(a, b))) * sign(pair_of(c, a)) >> 64);
                  }),
          slot<I>("mul.hi.u64", [](I a, I b, I c) {
            return static_cast<u64>(static_cast<unsigned __int128>(pair_of(a, b)) * pair_of(c, a) >> 64);
          })};
}

std::vector<Slot<I>> bits() {
  return {
      slot<I>("popc.b32", [](I a, I, I) { return static_cast<u32>(__builtin_popcount(a)); }),
      slot<I>("popc.b64", [](I a, I b, I) { return static_cast<u32>(__builtin_popcount(a) + __builtin_popcount(b)); }),
      slot<I>("clz.b32", [](I a, I, I) { return a ? 31 - highest(a) : 32; }),
      slot<I>("clz.b64", [](I a, I b, I) { return a || b ? 63 - highest(pair_of(a, b)) : 64; }),
      slot<I>("brev.b32",
              [](I a, I, I) {
                u32 r = 0;
                for (int k = 0; k < 32; ++k) r |= (a >> k & 1) << (31 - k);
                return r;
              }),
      slot<I>("brev.b64",
              [](I a, I b, I) {
                u64 r = 0;
                for (int k = 0; k < 64; ++k) r |= (pair_of(a, b) >> k & 1) << (63 - k);
                return r;
              }),
      slot<I>("bfind.u32", [](I a, I, I) { return highest(a); }),
      slot<I>("bfind.s32", [](I a, I, I) { return highest(sign(a)); }),
      slot<I>("bfind.shiftamt.u32", [](I a, I, I) { return highest(a) == ~0u ? ~0u : 31 - highest(a); }),
      slot<I>("bfind.shiftamt.s32", [](I a, I, I) { return highest(sign(a)) == ~0u ? ~0u : 31 - highest(sign(a)); }),
      slot<I>("bfind.u64", [](I a, I b, I) { return highest(pair_of(a, b)); }),
      slot<I>("bfind.s64", [](I a, I b, I) { return highest(sign(pair_of(a, b))); }),
      slot<I>("bfe.u32", [](I a, I b, I c) { return field(a, b, c); }),
      slot<I>("bfe.s32", [](I a, I b, I c) { return field(sign(a), b, c); }),
      slot<I>("bfe.u64", [](I a, I b, I c) { return field(pair_of(a, b), b, c); }),
      slot<I>("bfe.s64", [](I a, I b, I c) { return field(sign(pair_of(a, b)), b, c); }),
      slot<I>("bfi.b32", [](I a, I b, I c) { return inserted(a, c, b, c); }),
      slot<I>("bfi.b64", [](I a, I b, I c) { return inserted(pair_of(a, b), pair_of(c, a), b, c); }),
      slot<I>("prmt", [](I a, I b, I c) { return permuted(a, b, c); }),
      slot<I>("shf.l.wrap", [](I a, I b, I c) { return c % 32 ? b << c % 32 | a >> (32 - c % 32) : b; }),
      slot<I>("shf.l.clamp", [](I a, I b, I c) { return c > 31 ? a
                                                        : c    ? b << c | a >> (32 - c)
                                                               : b; }),
      slot<I>("shf.r.wrap", [](I a, I b, I c) { return c % 32 ? a >> c % 32 | b << (32 - c % 32) : a; }),
      slot<I>("shf.r.clamp", [](I a, I b, I c) { return c > 31 ? b
                                                        : c    ? a >> c | b << (32 - c)
                                                               : a; }),
      slot<I>("sad.s32", [](I a, I b, I c) { return c + (sign(a) < sign(b) ? b - a : a - b); }),
      slot<I>("sad.u32", [](I a, I b, I c) { return c + (a < b ? b - a : a - b); }),
      slot<I>("lop3 0x96", [](I a, I b, I c) { return a ^ b ^ c; }),
      slot<I>("lop3 0x2b", [](I a, I b, I c) { return (~a & ~b) | (~a & b & c) | (a & ~b & c); }),
      slot<I>("cnot", [](I a, I, I) { return u32{a == 0}; }),
      slot<I>("slct", [](I a, I b, I c) { return sign(c) >= 0 ? a : b; })};
}

std::vector<Slot<I>> others() {
  return {slot<I>("cvt.u32.u8", [](I a, I, I) { return a & 0xff; }),
          slot<I>("cvt.s32.s8", [](I a, I, I) { return static_cast<s32>(static_cast<s8>(a)); }),
          slot<I>("cvt.u16.u8", [](I a, I, I) { return a & 0xff; }),
          slot<I>("cvt.sat.u8.s32", [](I a, I, I) { return std::clamp(sign(a), 0, 255); }),
          slot<I>("cvt.sat.s8.s32", [](I a, I, I) { return std::clamp(sign(a), -128, 127); }),
          slot<I>("cvt.sat.s32.u32", [](I a, I, I) { return std::min(a, 0x7fffffffu); }),
          slot<I>("cvt.sat.u32.s32", [](I a, I, I) { return std::max(sign(a), 0); }),
          slot<I>("cvt.sat.u16.u32", [](I a, I, I) { return std::min(a, 0xffffu); }),
          slot<I>("bytes in local memory", [](I a, I b, I) { return (a & 0xff00ffffu) | (b & 0xff) << 16; }),
          slot<I>("ld.local.s8", [](I a, I, I) { return sign(a) >> 24; }),
          slot<I>("ld.local.u8", [](I a, I, I) { return a >> 24; }),
          slot<I>("ld.const.u8",
                  [](I a, I, I) {
                    return std::vector<u32>{7, 200, 0, 255}[a & 3];
                  }),
          slot<I>("ld.global of a table", [](I, I, I) { return 4000000000u; }),
          slot<I>("a scope", [](I a, I, I) { return a + 1; }),
          slot<I>("a call", [](I a, I b, I) { return a - b; }),
          slot<I>("brx.idx", [](I a, I, I) { return a & 1 ? 31u : 30u; })};
}

std::vector<Slot<I>> all() { return joined<I>({division(), bits(), others()}); }

const std::vector<u32> kIntegers = {0,          1,          2,          5,          8,         31,     32,
                                    33,         63,         0x100,      0x7fff,     0x8000,    0xffff, 0x7fffffff,
                                    0x80000000, 0x80000001, 0xffffffff, 0xfffffffe, 123456789, 0x7531, 0xfedc9876};

TEST(TwinOps, Bits) { check<semantics_bits, u32>(all(), kIntegers); }
TEST(TwinOps, BitsOnADevice) { check_on_device<semantics_bits, u32>("semantics_bits.ptx", all(), kIntegers); }

}  // namespace
}  // namespace ptx
}  // namespace GRAZE_FP
}  // namespace graze::cuda
