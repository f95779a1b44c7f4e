// SPDX-License-Identifier: Apache-2.0
// A predicate without a twin: it has approximate operations, whose results depend on the device.
__device__ bool intersects(const float a[9], const float b[9]) {
  const float length = rsqrtf(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  return __fdividef(a[0], b[0]) < length * b[1];
}
