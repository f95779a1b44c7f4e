// SPDX-License-Identifier: Apache-2.0
// For tests: arrays of triangles, and queries on them.
#pragma once

#include <algorithm>
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

template <class Real>
BasicPair<Real> pair_of(const std::array<Real, 9>& a, const std::array<Real, 9>& b) {
  BasicPair<Real> pair;
  std::memcpy(pair.a, a.data(), sizeof pair.a);
  std::memcpy(pair.b, b.data(), sizeof pair.b);
  return pair;
}

// The thesis's reference triangle, and `count` of its random triangles.
inline const Triangle kThesisReference = {2, -2, 4, 1, 5, -2, 1, -3, -3};
inline std::vector<Triangle> thesis_triangles(std::size_t count, std::uint64_t seed = 1) {
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < count; ++i)
    triangles.push_back(triangle(strata::generate(seed, strata::Stratum::thesis, i).b));
  return triangles;
}

// The same triangles in every layout, with coordinates of the given type.
template <class Real>
struct EveryLayout {
  struct Wide {
    std::array<Real, 9> triangle;
    Real more[sizeof(Real) / sizeof(float)];
  };
  std::vector<std::array<Real, 9>> rows;
  std::vector<Wide> wide;
  std::vector<Real> columns[9];
  std::vector<std::array<Real, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> faces;

  template <class From>
  explicit EveryLayout(const std::vector<std::array<From, 9>>& triangles) {
    for (const std::array<From, 9>& t : triangles) {
      std::copy(t.begin(), t.end(), rows.emplace_back().begin());
      wide.push_back({rows.back(), {1}});
      for (std::size_t k = 0; k < 9; ++k) columns[k].push_back(t[k]);
      const auto v = static_cast<std::uint32_t>(vertices.size());
      for (std::size_t k = 0; k < 9; k += 3) vertices.push_back({t[k], t[k + 1], t[k + 2]});
      faces.push_back({v, v + 1, v + 2});
    }
  }

  std::vector<graze_triangles> parts() const {
    std::array<const Real*, 9> at;
    for (std::size_t k = 0; k < 9; ++k) at[k] = columns[k].data();
    return {rows_of(std::span<const std::array<Real, 9>>(rows)), rows_of(std::span<const Wide>(wide)),
            columns_of(at, rows.size()), mesh_of(vertices, faces)};
  }
};

inline graze_triangles part_of(const std::vector<Triangle>& triangles) {
  return rows_of(std::span<const Triangle>(triangles));
}

}  // namespace graze::query
