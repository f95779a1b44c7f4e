// SPDX-License-Identifier: Apache-2.0
// A predicate that works on the bits of floats as integers: signs, exponents, masks, permuted bytes.
__device__ int ordered(float x) {
  const int bits = __float_as_int(x);
  return bits ^ ((bits >> 31) & 0x7fffffff);
}

__device__ bool intersects(const float a[9], const float b[9]) {
  unsigned mask = 0, mixed = 0x9e3779b9u;
  unsigned char exponents[18];
  for (int i = 0; i < 9; ++i) {
    mask |= (unsigned)(ordered(a[i]) < ordered(b[i])) << i;
    exponents[i] = (unsigned char)((__float_as_uint(a[i]) >> 23) & 0xff);
    exponents[9 + i] = (unsigned char)((__float_as_uint(b[i]) >> 23) & 0xff);
    mixed = __funnelshift_l(mixed, __float_as_uint(a[i] * b[i]), 7) ^ __byte_perm(mixed, mask, 0x1407);
    mixed += __usad(mixed & 0xffff, mask, 3) + __umulhi(mixed, 0x85ebca6bu);
  }
  const unsigned char most = exponents[mixed % 18];
  const int leading = __clz((int)(mask | 1)), first = __ffs((int)mask), last = 31 - __clz((int)__brev(mixed));
  const long long wide = (long long)mixed * leading - ((long long)most << 33);
  const signed char low = (signed char)(wide >> 5);
  return __popc(mask ^ (mixed >> 23)) + first > 6 || low < last - 16 || __popcll((unsigned long long)wide) > 40;
}
