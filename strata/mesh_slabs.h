// SPDX-License-Identifier: Apache-2.0
// The broad phase of `graze query`: the pairs of triangles whose closed boxes overlap, within one mesh or between two.
// The first mesh is cut into slabs along the longest axis. Slabs are independent, so threads can work on several at
// once, and a run can show its progress and stop between slabs. CGAL intersects the boxes of each slab.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "core/vec3.h"

namespace graze::strata {

class BoxSlabs {
 public:
  using Triangles = std::span<const std::array<Vec3<float>, 3>>;
  static constexpr std::size_t kTriangles = std::size_t{1} << 14;  // triangles of the first mesh in a slab

  // Pairs the triangles of `a` with those of `b`, or with each other if there is no `b`. Ignores triangles that are not
  // finite.   Requires: at most 2^32 - 1 triangles in each.
  BoxSlabs(Triangles a, std::optional<Triangles> b, std::size_t triangles_of_slab = kTriangles);
  ~BoxSlabs();

  std::size_t size() const;
  // How many triangles of `a` lie in the slabs before this one. If slab == size(), all finite triangles of `a` count.
  std::size_t triangles_before(std::size_t slab) const;
  std::uint64_t not_finite() const;  // how many triangles of both meshes are not finite

  // Calls found(i, j) once for each pair of the slab, in any order. i is in `a` and j in `b`; without `b`, both are in
  // `a`, and i < j. Each pair is in one slab. Several threads may call `pairs` at once. An exception from `found` ends
  // the call.
  // Throws: Stopped, soon after a request to stop.
  void pairs(std::size_t slab, const std::function<void(std::uint32_t, std::uint32_t)>& found) const;

 private:
  struct Boxes;
  std::unique_ptr<const Boxes> boxes_;
};

}  // namespace graze::strata
