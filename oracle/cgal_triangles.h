// SPDX-License-Identifier: Apache-2.0
// Triangles in CGAL's types, for `graze bench`, which compares the exact decision with CGAL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "core/vec3.h"

namespace graze::oracle {

// A mesh's triangles, for CGAL's do_intersect (`graze bench --between`).
class CgalTriangles {
 public:
  using Triangle = std::array<Vec3<float>, 3>;

  explicit CgalTriangles(std::span<const Triangle> triangles);  // the array must outlive this object
  ~CgalTriangles();

  // Calls CGAL::do_intersect on two Triangle_3 of the kernel with exact predicates. CGAL requires proper triangles, so
  // cgal_verdict decides pairs with a degenerate triangle.   Requires: finite coordinates.   Exact: always.
  bool intersect(std::size_t i, const CgalTriangles& others, std::size_t j) const;

 private:
  struct Converted;
  std::unique_ptr<const Converted> converted_;
};

// CGAL's tree of bounding boxes over an array of triangles, for queries.
class AabbTree {
 public:
  // Omits triangles without area, because CGAL's trees reject them.   Requires: finite coordinates.
  explicit AabbTree(std::span<const std::array<float, 9>> triangles);
  ~AabbTree();
  // The exact number of the tree's triangles that intersect the reference.   Requires: the reference is not degenerate.
  std::uint64_t count(const std::array<float, 9>& reference) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace graze::oracle
