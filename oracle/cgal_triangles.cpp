// SPDX-License-Identifier: Apache-2.0
#include "oracle/cgal_triangles.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "oracle/truth.h"

namespace graze::oracle {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, std::vector<Kernel::Triangle_3>::const_iterator>;

Kernel::Triangle_3 triangle(const std::array<float, 9>& t) {
  return {{double(t[0]), double(t[1]), double(t[2])},
          {double(t[3]), double(t[4]), double(t[5])},
          {double(t[6]), double(t[7]), double(t[8])}};
}

}  // namespace

struct CgalTriangles::Converted {
  std::span<const Triangle> stored;
  std::vector<Kernel::Triangle_3> triangles;
  std::vector<bool> is_degenerate;  // also true for triangles that are not finite
};

CgalTriangles::CgalTriangles(std::span<const Triangle> triangles) {
  auto converted = std::make_unique<Converted>();
  converted->stored = triangles;
  for (const Triangle& t : triangles) {
    const auto point = [](const Vec3<float>& v) { return Kernel::Point_3(double(v.x), double(v.y), double(v.z)); };
    const auto finite = [](const Vec3<float>& v) {
      return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    };
    converted->triangles.emplace_back(point(t[0]), point(t[1]), point(t[2]));
    converted->is_degenerate.push_back(!std::all_of(t.begin(), t.end(), finite) ||
                                       converted->triangles.back().is_degenerate());
  }
  converted_ = std::move(converted);
}

CgalTriangles::~CgalTriangles() = default;

bool CgalTriangles::intersect(std::size_t i, const CgalTriangles& others, std::size_t j) const {
  const Converted &own = *converted_, &other = *others.converted_;
  if (!own.is_degenerate[i] && !other.is_degenerate[j]) return CGAL::do_intersect(own.triangles[i], other.triangles[j]);
  const Triangle &a = own.stored[i], &b = other.stored[j];
  return cgal_verdict({{a[0], a[1], a[2]}, {b[0], b[1], b[2]}}) == Verdict::intersects;
}

struct AabbTree::Tree {
  std::vector<Kernel::Triangle_3> triangles;
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
