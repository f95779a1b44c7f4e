// SPDX-License-Identifier: Apache-2.0
// For tests: arrays of triangles, and queries on them.
#pragma once

#include <array>
#include <cstring>
#include <vector>

#include <graze/query.h>

#include "core/pair.h"
#include "strata/strata.h"

namespace graze::query {

template <class Real>
std::array<Real, 9> triangle(const Vec3<Real>* v) {
  std::array<Real, 9> t;
  std::memcpy(t.data(), v, sizeof t);
  return t;
}

// The thesis's reference triangle, and `count` of its random triangles.
inline const Triangle kThesisReference = {2, -2, 4, 1, 5, -2, 1, -3, -3};
inline std::vector<Triangle> thesis_triangles(std::size_t count, std::uint64_t seed = 1) {
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < count; ++i)
    triangles.push_back(triangle(strata::generate(seed, strata::Stratum::thesis, i).b));
  return triangles;
}

inline graze_triangles part_of(const std::vector<Triangle>& triangles) {
  return rows_of(std::span<const Triangle>(triangles));
}

}  // namespace graze::query
