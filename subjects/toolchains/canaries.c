/* SPDX-License-Identifier: Apache-2.0
 * Canaries: small computations whose bits show how a compiler and a processor treat them. C11 or C++17.
 * Each canary prints one line: its name, its type, and its results in hexadecimal. canaries.cpp judges the results.
 * The file includes itself, once for float and once for double, so compilers need its absolute path.
 */
#ifndef REAL
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static uint64_t seed = 1;
static uint64_t next_random(void) { /* Marsaglia's xorshift */
  seed ^= seed << 13;
  seed ^= seed >> 7;
  return seed ^= seed << 17;
}

/* A 128-bit integer, modulo 2^128. */
struct wide {
  uint64_t high, low;
};

static struct wide product(uint64_t a, uint64_t b) {
  const uint64_t half = 0xffffffff, low = (a & half) * (b & half), across = (a >> 32) * (b & half) + (low >> 32),
                 other = (a & half) * (b >> 32) + (across & half);
  const struct wide result = {(a >> 32) * (b >> 32) + (across >> 32) + (other >> 32), other << 32 | (low & half)};
  return result;
}

static struct wide difference(struct wide a, struct wide b) {
  const struct wide result = {a.high - b.high - (a.low < b.low), a.low - b.low};
  return result;
}

/* Whether -most_below <= a <= most_above. */
static int is_within(struct wide a, uint64_t most_below, uint64_t most_above) {
  return (a.high == 0 && a.low <= most_above) || (a.high == ~(uint64_t)0 && a.low != 0 && 0 - a.low <= most_below);
}

#define JOINED(name, type) name##_##type
#define NAMED(name, type) JOINED(name, type)
#define T(name) NAMED(name, TYPE)
#define TEXT(word) #word
#define TEXT_OF(word) TEXT(word)

#define REAL float
#define TYPE f32
#define BITS uint32_t
#define DIGITS 24
#define BIAS 127
#define SQRT sqrtf
#define FMA fmaf
#include __FILE__
#undef REAL
#undef TYPE
#undef BITS
#undef DIGITS
#undef BIAS
#undef SQRT
#undef FMA
#define REAL double
#define TYPE f64
#define BITS uint64_t
#define DIGITS 53
#define BIAS 1023
#define SQRT sqrt
#define FMA fma
#include __FILE__

int main(void) {
  canaries_f32();
  canaries_f64();
  return 0;
}

#else /* the canaries for one type */

/* 2^exponent, for an exponent of a normal number. */
static REAL T(power)(int exponent) {
  const BITS bits = (BITS)(BIAS + exponent) << (DIGITS - 1);
  REAL x;
  memcpy(&x, &bits, sizeof x);
  return x;
}

/* x, rounded to its type and hidden from the compiler. */
static REAL T(hidden)(REAL x) {
  volatile REAL stored = x;
  return stored;
}

static BITS T(bits)(REAL x) {
  const REAL stored = T(hidden)(x);
  BITS bits;
  memcpy(&bits, &stored, sizeof bits);
  return bits;
}

static void T(begin)(const char* name) { printf("\n%s %s", name, TEXT_OF(TYPE)); }
static void T(whole)(uint64_t number) { printf(" %llx", (unsigned long long)number); }
static void T(result)(REAL x) { T(whole)(T(bits)(x)); }

/* The number 1 + n h. h is so small that (1 + n h)(1 - n h) = 1 - (n h)^2 rounds to 1, for |n| at most 2. */
static REAL T(factor)(int n) { return T(hidden)(1 + (REAL)n * T(power)(-(DIGITS + 1) / 2 - 2)); }

static REAL T(times)(REAL a, REAL b) { return a * b; }
static REAL (*volatile T(called_times))(REAL, REAL) = T(times);

static void T(expression)(void) {
  const REAL a = T(factor)(1), b = T(factor)(-1), c = T(hidden)(-1);
  T(begin)("expression");
  T(result)(a * b + c);
}

static void T(products)(void) {
  const REAL a = T(factor)(1), b = T(factor)(-1), c = T(factor)(2), d = T(factor)(-2);
  T(begin)("difference");
  T(result)(a * b - c * d);
}

static void T(dot3)(REAL x0, REAL y0, REAL x1, REAL y1, REAL x2, REAL y2) {
  const REAL a0 = T(hidden)(x0), b0 = T(hidden)(y0), a1 = T(hidden)(x1), b1 = T(hidden)(y1), a2 = T(hidden)(x2),
             b2 = T(hidden)(y2);
  T(result)(a0 * b0 + a1 * b1 + a2 * b2);
}

static void T(dot)(void) {
  const REAL a = T(factor)(1), b = T(factor)(-1), c = -T(factor)(2), d = T(factor)(-2);
  T(begin)("dot");
  T(dot3)(a, b, c, d, 0, 0);
  T(dot3)(0, 0, a, b, c, d);
}

static void T(loop)(void) {
  volatile int count = 128; /* hidden, so that the loop stays a loop */
  const int n = count;
  /* With 64 or fewer partial sums, the two products are in the same one. */
  REAL x[128], y[128], sum = 0;
  for (int i = 0; i < 128; ++i) {
    x[i] = i == 0 ? T(factor)(1) : i == 64 ? -T(factor)(2) : T(hidden)(0);
    y[i] = i == 0 ? T(factor)(-1) : i == 64 ? T(factor)(-2) : T(hidden)(0);
  }
  for (int i = 0; i < n; ++i) sum += x[i] * y[i];
  T(begin)("loop");
  T(result)(sum);
}

static void T(statements)(void) {
  const REAL a = T(factor)(1), b = T(factor)(-1), c = T(hidden)(-1);
  const REAL t = a * b;
  const REAL sum = t + c;
  T(begin)("statements");
  T(result)(sum);
}

static void T(inlined)(void) {
  const REAL a = T(factor)(1), b = T(factor)(-1), c = T(hidden)(-1);
  T(begin)("inlined");
  T(result)(T(times)(a, b) + c);
}

static void T(called)(void) {
  const REAL a = T(factor)(1), b = T(factor)(-1), c = T(hidden)(-1);
  T(begin)("called");
  T(result)(T(called_times)(a, b) + c);
}

static void T(sum3)(REAL x, REAL y, REAL z) {
  const REAL a = T(hidden)(x), b = T(hidden)(y), c = T(hidden)(z);
  T(result)(a + b + c);
}

/* Adds to 1 a term that is lost unless more digits are kept. */
static void T(sum)(void) {
  T(begin)("sum");
  T(sum3)(1, T(power)(-DIGITS - 6), -1);
}

static void T(sum_in_loop)(void) {
  volatile int count = 4;
  const int n = count;
  const REAL term = T(power)(-DIGITS - 6);
  REAL x[4], sum = 0;
  for (int i = 0; i < 4; ++i) x[i] = T(hidden)(i == 0 ? 1 : i == 3 ? -1 : term);
  for (int i = 0; i < n; ++i) sum += x[i];
  T(begin)("sum_in_loop");
  T(result)(sum);
}

static void T(order)(void) {
  const REAL large = T(power)(100);
  T(begin)("order");
  T(sum3)(large, -large, 1);
  T(sum3)(large, 1, -large);
  T(sum3)(1, large, -large);
}

static void T(order_in_loop)(void) {
  REAL x[64], sum = 0;
  for (int i = 0; i < 64; ++i) x[i] = T(hidden)(i == 0 ? T(power)(100) : i == 16 ? -T(power)(100) : 1);
  for (int i = 0; i < 64; ++i) sum += x[i];
  T(begin)("order_in_loop");
  T(result)(sum);
}

static void T(sum2)(REAL x, REAL y) {
  const REAL a = T(hidden)(x), b = T(hidden)(y);
  T(result)(a + b);
}

static void T(nearest)(void) {
  const REAL half = T(power)(-DIGITS), ulp = T(power)(1 - DIGITS);
  T(begin)("nearest");
  T(sum2)(1, half);
  T(sum2)(1 + ulp, half);
  T(sum2)(1, half * (1 + ulp));
}

/* Divides a product beyond the largest number by one of its factors. */
static void T(range)(void) {
  const int exponent = DIGITS == 24 ? 100 : 1000;
  const REAL a = T(hidden)(T(power)(exponent)), b = T(hidden)(a), c = T(hidden)(a);
  T(begin)("range");
  T(result)(a * b / c);
}

static void T(range_assigned)(void) {
  const int exponent = DIGITS == 24 ? 100 : 1000;
  const REAL a = T(hidden)(T(power)(exponent)), b = T(hidden)(a), c = T(hidden)(a);
  const REAL t = a * b;
  const REAL quotient = t / c;
  T(begin)("range_assigned");
  T(result)(quotient);
}

static void T(range_called)(void) {
  const int exponent = DIGITS == 24 ? 100 : 1000;
  const REAL a = T(hidden)(T(power)(exponent)), b = T(hidden)(a), c = T(hidden)(a);
  T(begin)("range_called");
  T(result)(T(called_times)(a, b) / c);
}

static void T(range_stored)(void) {
  const int exponent = DIGITS == 24 ? 100 : 1000;
  const REAL a = T(hidden)(T(power)(exponent)), b = T(hidden)(a), c = T(hidden)(a);
  T(begin)("range_stored");
  T(result)(T(hidden)(a * b) / c);
}

static void T(reciprocal)(void) {
  const REAL x = DIGITS == 24 ? 41 : 49, a = T(hidden)(x), b = T(hidden)(x), c = T(hidden)(x), d = T(hidden)(x),
             by = T(hidden)(x);
  const REAL q = a / by, r = b / by, s = c / by, t = d / by;
  T(begin)("reciprocal");
  T(result)(q);
  T(result)(r);
  T(result)(s);
  T(result)(t);
}

/* An integer of DIGITS binary digits. */
static uint64_t T(random_digits)(void) { return next_random() >> (64 - DIGITS) | (uint64_t)1 << (DIGITS - 1); }

static uint64_t T(digits_of)(BITS bits) {
  return (bits & (((BITS)1 << (DIGITS - 1)) - 1)) | (uint64_t)1 << (DIGITS - 1);
}
static int T(exponent_of)(BITS bits) { return (int)(bits >> (DIGITS - 1)) - BIAS; }

/* Whether x / y is rounded to nearest.   Requires: 1/2 <= x / y < 2; x and y below 2^DIGITS. */
static int T(is_quotient)(uint64_t x, uint64_t y) {
  const REAL a = T(hidden)((REAL)x), b = T(hidden)((REAL)y);
  const BITS bits = T(bits)(a / b);
  const int shift = DIGITS - 1 - T(exponent_of)(bits); /* the quotient is digits / 2^shift */
  if (shift != DIGITS - 1 && shift != DIGITS) return 0;
  /* The remainder is at most half of y, and never exactly half: x would then be a multiple of an odd number of DIGITS
   * + 1 digits. */
  return is_within(difference(product(x, (uint64_t)1 << shift), product(T(digits_of)(bits), y)), (y - 1) / 2,
                   (y - 1) / 2);
}

/* Whether sqrt(x 2^odd) is rounded to nearest.   Requires: x of DIGITS binary digits, odd 0 or 1. */
static int T(is_root)(uint64_t x, int odd) {
  /* The root is digits / 2^(even / 2), so digits^2 is nearly x 2^odd 2^even. */
  const int even = DIGITS % 2 ? DIGITS - 1 : DIGITS - 2 * odd;
  const REAL a = T(hidden)((REAL)(x << odd));
  const BITS bits = T(bits)(SQRT(a));
  const uint64_t digits = T(digits_of)(bits);
  if (T(exponent_of)(bits) != DIGITS - 1 - even / 2) return 0;
  /* (digits - 1/2)^2 and (digits + 1/2)^2 are digits^2 + 1/4, minus and plus digits. */
  return is_within(difference(product(x, (uint64_t)1 << (odd + even)), product(digits, digits)), digits - 1, digits);
}

/* Half of the quotients are as near as possible to the middle between two numbers: x / y = (middle +- 1 / y) /
 * 2^(DIGITS + 1) with an odd `middle` of DIGITS + 1 digits. So y is the inverse of `middle` modulo 2^(DIGITS + 1), or
 * minus it. */
static void T(division)(void) {
  const uint64_t unit = (uint64_t)1 << (DIGITS + 1), least = unit >> 2;
  unsigned wrong = 0, asked = 0;
  while (asked < 16384) {
    const uint64_t x = T(random_digits)(), y = T(random_digits)(),
                   middle = next_random() >> (63 - DIGITS) | unit >> 1 | 1;
    uint64_t inverse = middle; /* correct to 3 binary digits; each step doubles their number */
    for (int i = 0; i < 5; ++i) inverse *= 2 - middle * inverse;
    inverse &= unit - 1;
    const uint64_t divisor = inverse < unit - inverse ? inverse : unit - inverse;
    if (divisor < least) continue;
    struct wide multiple = product(middle, divisor);
    const struct wide one = {0, 1}, minus_one = {~(uint64_t)0, ~(uint64_t)0};
    multiple = difference(multiple, divisor == inverse ? one : minus_one);
    wrong += !T(is_quotient)(x, y);
    wrong += !T(is_quotient)(multiple.high << (63 - DIGITS) | multiple.low >> (DIGITS + 1), divisor);
    asked += 2;
  }
  T(begin)("division");
  T(whole)(wrong);
  T(whole)(asked);
}

/* Half of the roots are near the middle between two numbers: 4 x 2^shift is middle^2 - d, with a small d and an odd
 * `middle` of DIGITS + 1 digits. So `middle` is a root of d modulo 2^(shift + 2). Because d is 1 modulo 8, it has four
 * such roots. */
static void T(root)(void) {
  unsigned wrong = 0, asked = 0;
  for (uint64_t i = 1; asked < 4096; ++i) {
    const int odd = (int)(i & 1), shift = DIGITS % 2 ? DIGITS - 1 + odd : DIGITS - odd;
    const uint64_t d = i & 2 ? 8 * (i >> 2) + 1 : 1 - 8 * (i >> 2), unit = (uint64_t)1 << (shift + 2);
    uint64_t some = 1;
    for (int n = 3; n < shift + 2; ++n) {
      if ((some * some - d) >> n & 1) some += (uint64_t)1 << (n - 1);
    }
    for (int k = 0; k < 4; ++k) {
      const uint64_t middle = ((k & 1 ? some : 0 - some) + (k & 2 ? unit / 2 : 0)) & (unit - 1);
      if (middle >> DIGITS != 1) continue;
      const struct wide square = product(middle, middle), small = {d >> 63 ? ~(uint64_t)0 : 0, d};
      const struct wide x = difference(square, small);
      const uint64_t digits = x.high << (62 - shift) | x.low >> (shift + 2);
      if (digits >> (DIGITS - 1) != 1) continue;
      wrong += !T(is_root)(digits, odd);
      wrong += !T(is_root)(T(random_digits)(), odd);
      asked += 2;
    }
  }
  T(begin)("root");
  T(whole)(wrong);
  T(whole)(asked);
}

static void T(fma3)(REAL x, REAL y, REAL z) {
  const REAL a = T(hidden)(x), b = T(hidden)(y), c = T(hidden)(z);
  T(result)(FMA(a, b, c));
}

static void T(fused)(void) {
  const REAL half = T(power)(-DIGITS), ulp = 2 * half, tiny = T(power)(-100), most = T(power)(BIAS);
  /* The product a b is in the middle between two numbers. */
  const REAL a = 1 + T(power)(-(DIGITS / 2)), b = 1 + T(power)(-(DIGITS - DIGITS / 2));
  const REAL least = T(power)(1 - BIAS) * ulp; /* the least subnormal number */
  const int down = (BIAS + DIGITS - 2) / 2;    /* least = 2^-(BIAS + DIGITS - 2) */
  T(begin)("fma");
  T(fma3)(T(factor)(1), T(factor)(-1), -1);
  T(fma3)(a, b, 0);
  T(fma3)(a, b, tiny);
  T(fma3)(a, b, -tiny);
  T(fma3)(a, b, ulp);
  T(fma3)(half * (1 + ulp), 1 - ulp, 1 + ulp);
  T(fma3)(most, 2, -most);
  T(fma3)(T(power)(-down), T(power)(down - BIAS - DIGITS + 1) * (1 + ulp), 2 * least);
  T(fma3)(1, 1, -1);
  T(fma3)(-1, 0, -T(hidden)(0));
}

static void T(identities)(void) {
  const REAL large = T(hidden)(T(power)(BIAS));
  const REAL zero = T(hidden)(0), infinite = T(hidden)(large * 2), other = T(hidden)(large * 2);
  T(begin)("identities");
  T(result)(zero / zero);
  T(result)(infinite / infinite);
  T(result)(infinite - infinite);
  T(result)(other * 0);
}

static void T(subnormal_result)(void) {
  const REAL least = T(hidden)(T(power)(1 - BIAS)), half = T(hidden)((REAL)0.5), other = T(hidden)(least * (REAL)1.5);
  T(begin)("subnormal_result");
  T(result)(least * half);
  T(result)(other - least);
}

/* A product a little below the middle between the least subnormal number and the next number. */
static void T(subnormal_nearest)(void) {
  const REAL g = T(power)(3 - DIGITS);
  const int half = (BIAS + DIGITS - 1) / 2;
  const REAL a = T(hidden)((3 + 3 * g) * T(power)(-half)), b = T(hidden)((1 - g) * T(power)(half - BIAS - DIGITS + 1));
  T(begin)("subnormal_nearest");
  T(result)(a * b);
}

static void T(subnormal_input)(void) {
  const BITS bits = 3;
  volatile REAL stored;
  REAL x;
  memcpy(&x, &bits, sizeof x);
  stored = x;
  T(begin)("subnormal_input");
  T(result)(stored * T(hidden)(T(power)(BIAS - 1)));
}

static void T(zeros)(void) {
  const REAL zero = T(hidden)(0), other = T(hidden)(0), one = T(hidden)(1), same = T(hidden)(1);
  const REAL negative = T(hidden)(T(hidden)(-1) * zero);
  T(begin)("zeros");
  T(result)(zero * -1);
  T(result)(negative + 0);
  T(result)(0 - other);
  T(result)(-(one - same));
}

static void T(nan)(void) {
  const BITS bits = (((BITS)1 << (8 * sizeof(BITS) - DIGITS + 1)) - 1) << (DIGITS - 2); /* quiet */
  volatile REAL stored;
  REAL x, y;
  memcpy(&x, &bits, sizeof x);
  stored = x;
  x = stored;
  y = stored;
  T(begin)("nan");
  T(whole)(x == x);
  T(whole)(x != x);
  T(whole)(!(y < 1));
  T(whole)(y >= 1);
}

static void T(infinity)(void) {
  const REAL large = T(hidden)(T(power)(BIAS)), zero = T(hidden)(0), one = T(hidden)(1);
  const REAL infinite = T(hidden)(large * 2);
  T(begin)("infinity");
  T(result)(large * 2);
  T(result)(-one / zero);
  T(whole)(large < infinite);
  T(whole)(infinite == infinite + 1);
}

static void T(canaries)(void) {
  T(expression)();
  T(products)();
  T(dot)();
  T(loop)();
  T(statements)();
  T(inlined)();
  T(called)();
  T(sum)();
  T(sum_in_loop)();
  T(order)();
  T(order_in_loop)();
  T(nearest)();
  T(range)();
  T(range_assigned)();
  T(range_called)();
  T(range_stored)();
  T(reciprocal)();
  T(division)();
  T(root)();
  T(fused)();
  T(identities)();
  T(subnormal_result)();
  T(subnormal_nearest)();
  T(subnormal_input)();
  T(zeros)();
  T(nan)();
  T(infinity)();
  printf("\n");
}
#endif
