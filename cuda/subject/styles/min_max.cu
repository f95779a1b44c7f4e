// SPDX-License-Identifier: Apache-2.0
// A predicate on boxes and projections, with fminf, fmaxf, copysignf, signbit, isnan and isfinite.
__device__ float least(const float* t, int k) { return fminf(fminf(t[k], t[k + 3]), t[k + 6]); }
__device__ float most(const float* t, int k) { return fmaxf(fmaxf(t[k], t[k + 3]), t[k + 6]); }

__device__ bool intersects(const float a[9], const float b[9]) {
  for (int k = 0; k < 3; ++k) {
    if (!isfinite(a[k]) || isnan(b[k])) return false;
    if (fmaxf(least(a, k), least(b, k)) > fminf(most(a, k), most(b, k))) return false;
  }
  const float way = copysignf(fabsf(a[0]) - fabsf(b[0]), a[1] * b[1] - a[2] * b[2]);
  const float nan = (a[3] - a[3]) / (b[3] - b[3]);
  return signbit(way) ? fmaxf(nan, way) < b[4] : fminf(way, nan) > a[4] || fdimf(a[5], b[5]) > 0.5f;
}
