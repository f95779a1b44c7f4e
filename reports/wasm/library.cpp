// SPDX-License-Identifier: Apache-2.0
// What the module does not take from elsewhere: correct fused multiply-adds, lanes that it cannot build, and the parts
// of twin.h that know of users' libraries.
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/lanes/host_blocks.h"
#include "cuda/twin/twin_table.h"

// That of wasi-libc is wrong where the result is subnormal and lies halfway between two numbers. Here the product is
// exact in double, and the sum rounded to odd (Boldo and Melquiond 2008): its last bit says whether anything was lost,
// so that the second rounding rounds as one alone would.
extern "C" float fmaf(float x, float y, float z) {
  const double product = double{x} * double{y}, addend = z;
  const double sum = product + addend, part = sum - product;
  const double lost = (product - (sum - part)) + (addend - part);  // Knuth's TwoSum
  if (lost == 0 || !std::isfinite(sum)) return static_cast<float>(sum);
  auto bits = std::bit_cast<std::uint64_t>(sum);
  if ((bits & 1) == 0) bits += (lost < 0) == std::signbit(sum) ? 1 : -1;
  return static_cast<float>(std::bit_cast<double>(bits));
}

// That of wasi-libc, but where z is zero: there it adds the rounded product, and the sign of one that rounds to -0 is
// lost. The linker (--wrap) calls this for fma.
extern "C" double __real_fma(double x, double y, double z);
extern "C" double __wrap_fma(double x, double y, double z) {
  return z == 0 && x != 0 && y != 0 ? x * y : __real_fma(x, y, z);
}

// There are no exceptions: a throw ends the call with a trap, which JavaScript catches. The module's functions give
// nothing to the parts it is made of at which they would throw.
extern "C" void* __cxa_allocate_exception(std::size_t) { __builtin_trap(); }
extern "C" void __cxa_throw(void*, void*, void (*)(void*)) { __builtin_trap(); }

namespace graze {

// Another compiler contracts otherwise, so that these lanes exist in the native build alone.
namespace cpu_fma {
extern const HostBlocks kHostBlocks{};
extern const HostPolicyBlocks kHostPolicyBlocks{};
}  // namespace cpu_fma
namespace cpu_fast {
extern const HostBlocks kHostBlocks{};
extern const HostPolicyBlocks kHostPolicyBlocks{};
}  // namespace cpu_fast

namespace cuda {

std::span<const ContractionSite> contraction_sites(const Lane& lane) { return twin_row(lane).sites; }

Verdict decide_fusing(const Lane& lane, const Pair& pair, std::span<const std::uint64_t> fused) {
  return twin_row(lane).decide_fusing(pair, fused.data());
}

}  // namespace cuda
}  // namespace graze
