/* SPDX-License-Identifier: Apache-2.0
 * Replaces CUDA's headers when a host compiler compiles a CUDA source. Defines decorations, vector types and their
 * functions. As in nvcc's host pass, __CUDACC__ is defined and __CUDA_ARCH__ is not. Intrinsics such as __fmul_rn are
 * left out, because a compiler that contracts would not keep their rounding. */
#pragma once

#include <cfloat>
#include <cmath>

#define __CUDACC__ 1
#ifdef GRAZE_KEEP_DECORATIONS
#define __host__ graze_host
#define __device__ graze_device
#else
#define __host__
#define __device__
#endif
#define __global__
#define __constant__
#define __shared__
#define __forceinline__ inline
#define __align__(bytes) alignas(bytes)
#define __launch_bounds__(...)

#define GRAZE_VECTORS(Number, type)                                                 \
  struct type##2 {                                                                  \
    Number x, y;                                                                    \
  };                                                                                \
  struct type##3 {                                                                  \
    Number x, y, z;                                                                 \
  };                                                                                \
  struct type##4 {                                                                  \
    Number x, y, z, w;                                                              \
  };                                                                                \
  inline type##2 make_##type##2(Number x, Number y) { return {x, y}; }              \
  inline type##3 make_##type##3(Number x, Number y, Number z) { return {x, y, z}; } \
  inline type##4 make_##type##4(Number x, Number y, Number z, Number w) { return {x, y, z, w}; }
GRAZE_VECTORS(float, float)
GRAZE_VECTORS(double, double)
GRAZE_VECTORS(int, int)
GRAZE_VECTORS(unsigned, uint)
#undef GRAZE_VECTORS

/* Variables for kernels in the same file, which are never called. */
static const uint3 threadIdx{}, blockIdx{}, blockDim{}, gridDim{};

inline float min(float a, float b) { return std::fmin(a, b); }
inline float max(float a, float b) { return std::fmax(a, b); }
inline double min(double a, double b) { return std::fmin(a, b); }
inline double max(double a, double b) { return std::fmax(a, b); }
inline int min(int a, int b) { return b < a ? b : a; }
inline int max(int a, int b) { return a < b ? b : a; }
