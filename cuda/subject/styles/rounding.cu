// SPDX-License-Identifier: Apache-2.0
// A predicate that rounds to a grid with roundf, floorf, rintf, ceilf and truncf, and rounds bounds down or up.
__device__ float bounded(float x) { return fminf(fmaxf(x, -1e6f), 1e6f); }  // fits into an int

__device__ bool intersects(const float a[9], const float b[9]) {
  long long cells = 0;
  float low = 0, high = 0;
  for (int i = 0; i < 9; ++i) {
    const float scaled = bounded(a[i] * 16.0f), other = bounded(b[i] * 16.0f);
    cells += (int)roundf(scaled) - (int)floorf(other) + (int)ceilf(scaled) - __float2int_rn(b[i]);
    cells ^= (long long)truncf(scaled) + (unsigned)fabsf(rintf(scaled));
    low = __fadd_rd(low, __fmul_rd(a[i], b[i]));
    high = __fadd_ru(high, __fmul_ru(a[i], b[i]));
    low = __fsub_rd(low, __fdiv_rd(a[i], 3.0f));
    high = __fmaf_ru(a[i], -0.3f, __fsqrt_ru(fabsf(high)));
  }
  const double d = __dadd_rz((double)low, (double)high);
  const float narrow = __double2float_rz(d), whole = __int2float_rd((int)cells | 0x1000001);
  return low <= 0 && high >= 0 ? narrow < whole * 1e-9f : (cells & 3) == 1;
}
