// SPDX-License-Identifier: Apache-2.0
// A predicate with divisions of floats and integers, and remainders of signed and unsigned integers.
__device__ bool intersects(const float a[9], const float b[9]) {
  int steps = (int)fminf(fmaxf(a[0] * 37.0f, -1e6f), 1e6f), parts = (int)fminf(fmaxf(b[0] * 11.0f, -1e3f), 1e3f) | 1;
  const int quotient = steps / parts, rest = steps % parts;
  const unsigned scale = (unsigned)parts * 2654435761u, slots = (unsigned)steps | 1u;
  const unsigned slot = scale % slots, turn = scale / slots;
  const long long far = ((long long)scale << 20 | turn) % ((long long)steps * 3 + 7000001) / 3;
  const float middle = (a[(slot % 9)] + b[(turn + 4) % 9]) / (a[3] - b[3]);
  const double slope = ((double)a[4] - b[5]) / ((double)a[5] + 3.0 * b[4]);
  if (quotient > rest) return middle < (float)slope;
  return slope > middle / 7.0f && far % 5 != 2;
}
