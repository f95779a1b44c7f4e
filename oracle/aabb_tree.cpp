// SPDX-License-Identifier: Apache-2.0
#include "oracle/aabb_tree.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <vector>

namespace graze::oracle {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;

Kernel::Triangle_3 triangle(const std::array<float, 9>& t) {
  return {{double(t[0]), double(t[1]), double(t[2])},
          {double(t[3]), double(t[4]), double(t[5])},
          {double(t[6]), double(t[7]), double(t[8])}};
}

}  // namespace

struct AabbTree::Tree {
  Triangles triangles;
  CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> boxes;
};

AabbTree::AabbTree(std::span<const std::array<float, 9>> triangles) : tree_(std::make_unique<Tree>()) {
  tree_->triangles.reserve(triangles.size());
  for (const std::array<float, 9>& t : triangles) {
    tree_->triangles.push_back(triangle(t));
    if (tree_->triangles.back().is_degenerate()) tree_->triangles.pop_back();
  }
  tree_->boxes.insert(tree_->triangles.cbegin(), tree_->triangles.cend());
  tree_->boxes.build();
}

AabbTree::~AabbTree() = default;

std::uint64_t AabbTree::count(const std::array<float, 9>& reference) const {
  return tree_->boxes.number_of_intersected_primitives(triangle(reference));
}

}  // namespace graze::oracle
