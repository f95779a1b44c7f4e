// SPDX-License-Identifier: Apache-2.0
// Replacements for parts of the native build: correct fused multiply-adds, empty tables for lanes that the module
// lacks, backends without descriptions, and the functions of twin.h that would load users' libraries.
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "backends/backends.h"
#include "core/lanes/host_blocks.h"
#include "cuda/twin/twin.h"

// wasi-libc's fmaf is wrong if the result is subnormal and halfway between two numbers. Here the product is exact in
// double, and the sum is rounded to odd (Boldo and Melquiond 2008). The sum's last bit shows whether the sum was
// inexact, so the second rounding gives the same result as a single rounding.
extern "C" float fmaf(float x, float y, float z) {
  const double product = double{x} * double{y}, addend = z;
  const double sum = product + addend, part = sum - product;
  const double lost = (product - (sum - part)) + (addend - part);  // Knuth's TwoSum
  if (lost == 0 || !std::isfinite(sum)) return static_cast<float>(sum);
  auto bits = std::bit_cast<std::uint64_t>(sum);
  if ((bits & 1) == 0) bits += (lost < 0) == std::signbit(sum) ? 1 : -1;
  return static_cast<float>(std::bit_cast<double>(bits));
}

// Calls wasi-libc's fma unless z is zero. If z is zero, wasi-libc would add the rounded product, and lose the sign of a
// product that rounds to -0. The linker (--wrap) replaces calls of fma with calls of this function.
extern "C" double __real_fma(double x, double y, double z);
extern "C" double __wrap_fma(double x, double y, double z) {
  return z == 0 && x != 0 && y != 0 ? x * y : __real_fma(x, y, z);
}

// The module has no exceptions: a throw ends the call with a trap, which JavaScript catches. The module's code
// never calls a function with arguments for which it throws.
extern "C" void* __cxa_allocate_exception(std::size_t) { __builtin_trap(); }
extern "C" void __cxa_throw(void*, void*, void (*)(void*)) { __builtin_trap(); }

// The module needs no system functions of its host. It reads no environment variables and prints nothing. File
// functions are linked only because snprintf needs them.
extern "C" char* getenv(const char*) { return nullptr; }
extern "C" int __imported_wasi_snapshot_preview1_fd_close(int) { __builtin_trap(); }
extern "C" int __imported_wasi_snapshot_preview1_fd_seek(int, std::int64_t, int, int) { __builtin_trap(); }
extern "C" int __imported_wasi_snapshot_preview1_fd_write(int, int, int, int) { __builtin_trap(); }

// The module's only thread never ends, so its thread-local destructors are never called.
extern "C" int __cxa_thread_atexit(void (*)(void*), void*, void*) { return 0; }

namespace graze {

#ifdef GRAZE_FLOAT32_ALONE
namespace cpu {
extern const HostDoubleBlocks kHostDoubleBlocks{};
extern const HostDoublePolicyBlocks kHostDoublePolicyBlocks{};
}  // namespace cpu
#endif

// These lanes exist only in the native build, because clang contracts differently from the native compiler.
namespace cpu_fma {
extern const HostBlocks kHostBlocks{};
extern const HostDoubleBlocks kHostDoubleBlocks{};
extern const HostPolicyBlocks kHostPolicyBlocks{};
extern const HostDoublePolicyBlocks kHostDoublePolicyBlocks{};
}  // namespace cpu_fma
namespace cpu_fast {
extern const HostBlocks kHostBlocks{};
extern const HostDoubleBlocks kHostDoubleBlocks{};
extern const HostPolicyBlocks kHostPolicyBlocks{};
extern const HostDoublePolicyBlocks kHostDoublePolicyBlocks{};
}  // namespace cpu_fast

namespace cuda {

std::span<const ContractionSite> contraction_sites(const Lane& lane) { return twin_row(lane).sites; }
std::span<const ContractionSite> contraction_sites(const Lane& lane, const AnyPair& pair) {
  return pair.floats ? twin_row(lane).sites : twin_row(lane).doubles.sites;
}

Verdict decide_fusing(const Lane& lane, const AnyPair& pair, std::span<const std::uint64_t> fused) {
  const TwinRow& row = twin_row(lane);
  return pair.floats ? row.decide_fusing(*pair.floats, fused.data())
                     : row.doubles.decide_fusing(pair.doubles, fused.data());
}

}  // namespace cuda

// These backends do not describe lanes, because descriptions would need output streams.
namespace backends {
const Backend& backend_of(const Lane& lane) {
  constexpr auto own_code = [](const Lane& of) { return of.decide; };
  static constexpr Backend kProcessor{"exact/f32/cpu", false, false, own_code, nullptr, nullptr};
  static constexpr Backend kTwins{"exact/f32/cuda", true, true, cuda::block_on_host, nullptr, nullptr};
  return info_of(lane.variant).runs_on == RunsOn::host ? kProcessor : kTwins;
}
}  // namespace backends
}  // namespace graze
