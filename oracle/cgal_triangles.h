// SPDX-License-Identifier: Apache-2.0
// The triangles of meshes as CGAL's own; `graze bench --between` compares its do_intersect with the exact decision.
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

  explicit CgalTriangles(std::span<const Triangle> triangles);  // which must stay in place
  ~CgalTriangles();

  // By CGAL::do_intersect of two Triangle_3 of the kernel with exact predicates; if one of them is degenerate, which
  // CGAL does not allow, by cgal_verdict.   Requires: finite coordinates.   Exact: always.
  bool intersect(std::size_t i, const CgalTriangles& others, std::size_t j) const;

 private:
  struct Converted;
  std::unique_ptr<const Converted> converted_;
};

}  // namespace graze::oracle
