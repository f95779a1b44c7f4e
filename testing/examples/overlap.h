// SPDX-License-Identifier: Apache-2.0
// The code under test: separating axes in double precision. It is exact on small integers and rounds on other numbers.
#pragma once

#include <algorithm>

inline void cross(const double* u, const double* v, double* result) {
  for (int i = 0; i < 3; ++i) result[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
}

inline bool separates(const double* axis, const double* a, const double* b) {
  double low[2], high[2];
  for (int t = 0; t < 2; ++t) {
    const double* at = t == 0 ? a : b;
    for (int v = 0; v < 3; ++v) {
      const double along = axis[0] * at[3 * v] + axis[1] * at[3 * v + 1] + axis[2] * at[3 * v + 2];
      low[t] = v == 0 ? along : std::min(low[t], along);
      high[t] = v == 0 ? along : std::max(high[t], along);
    }
  }
  return high[0] < low[1] || high[1] < low[0];
}

inline bool overlap(const double a[9], const double b[9]) {
  double edges[6][3], normals[2][3], axis[3];
  for (int e = 0; e < 6; ++e) {
    const double* at = e < 3 ? a : b;
    for (int i = 0; i < 3; ++i) edges[e][i] = at[(e + 1) % 3 * 3 + i] - at[e % 3 * 3 + i];
  }
  for (int t = 0; t < 2; ++t) {
    cross(edges[3 * t], edges[3 * t + 1], normals[t]);
    if (separates(normals[t], a, b)) return false;
  }
  for (int e = 0; e < 3; ++e) {
    for (int f = 3; f < 6; ++f) {
      cross(edges[e], edges[f], axis);
      if (separates(axis, a, b)) return false;
    }
  }
  for (int e = 0; e < 6; ++e) {  // for triangles in one plane
    cross(normals[e / 3], edges[e], axis);
    if (separates(axis, a, b)) return false;
  }
  return true;
}
