// SPDX-License-Identifier: Apache-2.0
// The engine's atomic operations, for device and host.
#pragma once

#include <cstdint>

#include "core/vec3.h"

namespace graze::cuda {

// Reads a published value. This thread then also sees everything that the publishing thread wrote earlier.
GRAZE_HD inline std::uint64_t load_published(const std::uint64_t* at) {
#ifdef __CUDA_ARCH__
  std::uint64_t value;
  asm volatile("ld.acquire.gpu.u64 %0, [%1];" : "=l"(value) : "l"(at) : "memory");
  return value;
#else
  return __atomic_load_n(at, __ATOMIC_ACQUIRE);
#endif
}

// Writes a value. Threads that read the value with load_published also see what this thread wrote earlier.
GRAZE_HD inline void publish(std::uint64_t* at, std::uint64_t value) {
#ifdef __CUDA_ARCH__
  asm volatile("st.release.gpu.u64 [%0], %1;" : : "l"(at), "l"(value) : "memory");
#else
  __atomic_store_n(at, value, __ATOMIC_RELEASE);
#endif
}

// Reads a value. The read does not order other memory accesses.
GRAZE_HD inline std::uint64_t load_relaxed(const std::uint64_t* at) {
#ifdef __CUDA_ARCH__
  return *const_cast<const volatile std::uint64_t*>(at);
#else
  return __atomic_load_n(at, __ATOMIC_RELAXED);
#endif
}

// Writes `to` if the value is `from`.   Returns: whether the value was `from`.
GRAZE_HD inline bool replace(std::uint64_t* at, std::uint64_t from, std::uint64_t to) {
#ifdef __CUDA_ARCH__
  return atomicCAS(reinterpret_cast<unsigned long long*>(at), from, to) == from;
#else
  return __atomic_compare_exchange_n(at, &from, to, false, __ATOMIC_ACQ_REL, __ATOMIC_ACQUIRE);
#endif
}

// Writes the value if it is less than the old value.   Returns: the old value.
GRAZE_HD inline std::uint64_t lower_to(std::uint64_t* at, std::uint64_t value) {
#ifdef __CUDA_ARCH__
  return atomicMin(reinterpret_cast<unsigned long long*>(at), value);
#else
  std::uint64_t old = __atomic_load_n(at, __ATOMIC_RELAXED);
  while (value < old && !__atomic_compare_exchange_n(at, &old, value, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
  return old;
#endif
}

GRAZE_HD inline void add(std::uint64_t* at, std::uint64_t value) {
#ifdef __CUDA_ARCH__
  atomicAdd(reinterpret_cast<unsigned long long*>(at), value);
#else
  __atomic_fetch_add(at, value, __ATOMIC_RELAXED);
#endif
}

// Adds 1.   Returns: the old value.
GRAZE_HD inline std::uint32_t add_one(std::uint32_t* at) {
#ifdef __CUDA_ARCH__
  return atomicAdd(at, 1u);
#else
  return __atomic_fetch_add(at, 1u, __ATOMIC_RELAXED);
#endif
}

}  // namespace graze::cuda
