// SPDX-License-Identifier: Apache-2.0
// GRAZE_HD marks functions that nvcc compiles for host and device. For other compilers it is empty.
#pragma once

#ifndef GRAZE_HD
#ifdef __CUDACC__
#define GRAZE_HD __host__ __device__
#else
#define GRAZE_HD
#endif
#endif

// GRAZE_CALLED marks a function that device code must not inline, because that would double nvcc's compile time.
#ifdef __CUDACC__
#define GRAZE_CALLED __noinline__
#else
#define GRAZE_CALLED
#endif
