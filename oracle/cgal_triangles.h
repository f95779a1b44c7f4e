// SPDX-License-Identifier: Apache-2.0
// A mesh's triangles as CGAL triangles; `graze bench --between` compares CGAL's do_intersect with the exact decision.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>

#include "core/vec3.h"

namespace graze::oracle {

class CgalTriangles {
 public:
  using Triangle = std::array<Vec3<float>, 3>;

  explicit CgalTriangles(std::span<const Triangle> triangles);  // the array must outlive this object
  ~CgalTriangles();

  // Calls CGAL::do_intersect on two Triangle_3 of the kernel with exact predicates. CGAL does not allow degenerate
  // triangles; if one of the two is degenerate, cgal_verdict decides.   Requires: finite coordinates.   Exact: always.
  bool intersect(std::size_t i, const CgalTriangles& others, std::size_t j) const;

 private:
  struct Converted;
  std::unique_ptr<const Converted> converted_;
};

}  // namespace graze::oracle
