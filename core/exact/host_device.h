// SPDX-License-Identifier: Apache-2.0
// GRAZE_HD marks functions that nvcc compiles for host and device; other compilers see nothing.
#pragma once

#ifndef GRAZE_HD
#ifdef __CUDACC__
#define GRAZE_HD __host__ __device__
#else
#define GRAZE_HD
#endif
#endif

// A function that device code calls: in each place anew it would be half of the time that nvcc takes.
#ifdef __CUDACC__
#define GRAZE_CALLED __noinline__
#else
#define GRAZE_CALLED
#endif
