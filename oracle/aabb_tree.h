// SPDX-License-Identifier: Apache-2.0
// CGAL's tree of bounding boxes over an array of triangles; `graze bench` compares queries with it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

namespace graze::oracle {

class AabbTree {
 public:
  // Builds the tree without triangles that have no area, which CGAL's trees reject.   Requires: finite coordinates.
  explicit AabbTree(std::span<const std::array<float, 9>> triangles);
  ~AabbTree();
  // How many of the tree's triangles intersect the reference, exactly.   Requires: the reference has an area.
  std::uint64_t count(const std::array<float, 9>& reference) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace graze::oracle
