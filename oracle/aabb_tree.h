// SPDX-License-Identifier: Apache-2.0
// CGAL's tree of bounding boxes over an array of triangles, beside which `graze bench` puts queries.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

namespace graze::oracle {

class AabbTree {
 public:
  // Builds it. Triangles without area are left out, which CGAL's trees do not take.   Requires: finite coordinates.
  explicit AabbTree(std::span<const std::array<float, 9>> triangles);
  ~AabbTree();
  // How many of its triangles meet the reference; exact.   Requires: a reference with area.
  std::uint64_t count(const std::array<float, 9>& reference) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace graze::oracle
