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

// A function that device code calls and does not inline: inlining it would double nvcc's time.
#ifdef __CUDACC__
#define GRAZE_CALLED __noinline__
#else
#define GRAZE_CALLED
#endif
