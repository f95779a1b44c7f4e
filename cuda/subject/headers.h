// SPDX-License-Identifier: Apache-2.0
// Replacements for standard headers that device code often includes and that NVRTC lacks. The device functions are
// built into NVRTC or defined here.
#pragma once

namespace graze::cuda {

// NVRTC declares the functions of <cmath> in the global namespace.
inline constexpr char kCmath[] = R"(#pragma once
#ifndef INFINITY
#define INFINITY __int_as_float(0x7f800000)
#endif
#ifndef NAN
#define NAN __int_as_float(0x7fffffff)
#endif
#define HUGE_VALF INFINITY
#define HUGE_VAL ((double)INFINITY)
#define M_PI 3.14159265358979323846
namespace std {
using ::abs; using ::fabs; using ::sqrt; using ::cbrt; using ::hypot; using ::fma; using ::fmin; using ::fmax;
using ::fdim; using ::fmod; using ::remainder; using ::floor; using ::ceil; using ::trunc; using ::round; using ::rint;
using ::nearbyint; using ::copysign; using ::nextafter; using ::isnan; using ::isinf; using ::isfinite; using ::signbit;
using ::pow; using ::exp; using ::log; using ::sin; using ::cos; using ::tan; using ::asin; using ::acos; using ::atan;
using ::atan2; using ::ldexp; using ::frexp; using ::scalbn; using ::ilogb;
}
)";

inline constexpr char kCfloat[] = R"(#pragma once
#define FLT_RADIX 2
#define FLT_MANT_DIG 24
#define FLT_EPSILON 0x1p-23f
#define FLT_MIN 0x1p-126f
#define FLT_TRUE_MIN 0x1p-149f
#define FLT_MAX 0x1.fffffep+127f
#define DBL_MANT_DIG 53
#define DBL_EPSILON 0x1p-52
#define DBL_MIN 0x1p-1022
#define DBL_TRUE_MIN 0x1p-1074
#define DBL_MAX 0x1.fffffffffffffp+1023
)";

inline constexpr char kClimits[] = R"(#pragma once
#define CHAR_BIT 8
#define INT_MAX 2147483647
#define INT_MIN (-2147483647 - 1)
#define UINT_MAX 4294967295u
#define LLONG_MAX 9223372036854775807ll
#define LLONG_MIN (-9223372036854775807ll - 1)
#define ULLONG_MAX 18446744073709551615ull
)";

inline constexpr char kCstdint[] = R"(#pragma once
typedef signed char int8_t; typedef short int16_t; typedef int int32_t; typedef long long int64_t;
typedef unsigned char uint8_t; typedef unsigned short uint16_t; typedef unsigned int uint32_t;
typedef unsigned long long uint64_t;
#define INT32_MAX 2147483647
#define UINT32_MAX 4294967295u
namespace std {
using ::int8_t; using ::int16_t; using ::int32_t; using ::int64_t;
using ::uint8_t; using ::uint16_t; using ::uint32_t; using ::uint64_t;
}
)";

inline constexpr char kLimits[] = R"(#pragma once
namespace std {
template <class T> struct numeric_limits;
template <> struct numeric_limits<float> {
  __device__ static constexpr float epsilon() { return 0x1p-23f; }
  __device__ static constexpr float min() { return 0x1p-126f; }
  __device__ static constexpr float denorm_min() { return 0x1p-149f; }
  __device__ static constexpr float max() { return 0x1.fffffep+127f; }
  __device__ static constexpr float lowest() { return -max(); }
  __device__ static float infinity() { return __int_as_float(0x7f800000); }
  __device__ static float quiet_NaN() { return __int_as_float(0x7fffffff); }
};
template <> struct numeric_limits<double> {
  __device__ static constexpr double epsilon() { return 0x1p-52; }
  __device__ static constexpr double min() { return 0x1p-1022; }
  __device__ static constexpr double denorm_min() { return 0x1p-1074; }
  __device__ static constexpr double max() { return 0x1.fffffffffffffp+1023; }
  __device__ static constexpr double lowest() { return -max(); }
  __device__ static double infinity() { return __longlong_as_double(0x7ff0000000000000ll); }
  __device__ static double quiet_NaN() { return __longlong_as_double(0x7fffffffffffffffll); }
};
template <> struct numeric_limits<int> {
  __device__ static constexpr int min() { return -2147483647 - 1; }
  __device__ static constexpr int max() { return 2147483647; }
};
}
)";

inline constexpr char kAlgorithm[] = R"(#pragma once
namespace std {
template <class T> __device__ constexpr const T& min(const T& a, const T& b) { return b < a ? b : a; }
template <class T> __device__ constexpr const T& max(const T& a, const T& b) { return a < b ? b : a; }
template <class T> __device__ constexpr void swap(T& a, T& b) { T c = a; a = b; b = c; }
}
)";

inline constexpr char kAssert[] = "#undef assert\n#define assert(condition) ((void)0)\n";
inline constexpr char kNothing[] = "#pragma once\n";

struct StubHeader {
  const char* name;
  const char* text;
};

inline constexpr StubHeader kStubHeaders[] = {
    {"math.h", kCmath},
    {"cmath", kCmath},
    {"float.h", kCfloat},
    {"cfloat", kCfloat},
    {"limits.h", kClimits},
    {"climits", kClimits},
    {"stdint.h", kCstdint},
    {"cstdint", kCstdint},
    {"limits", kLimits},
    {"algorithm", kAlgorithm},
    {"utility", kAlgorithm},
    {"assert.h", kAssert},
    {"cassert", kAssert},
    {"stdio.h", kNothing},
    {"cstdio", kNothing},
    {"stdlib.h", kNothing},
    {"cstdlib", kNothing},
    {"string.h", kNothing},
    {"cstring", kNothing},
    {"stddef.h", kNothing},
    {"cstddef", kNothing},
    {"stdbool.h", kNothing},
    {"cuda.h", kNothing},
    {"cuda_runtime.h", kNothing},
    {"cuda_runtime_api.h", kNothing},
    {"device_launch_parameters.h", kNothing},
    {"vector_types.h", kNothing},
    {"vector_functions.h", kNothing},
};

}  // namespace graze::cuda
