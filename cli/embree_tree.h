// SPDX-License-Identifier: Apache-2.0
// Embree's tree of bounding boxes over an array of triangles. If Embree is installed, `graze bench` compares the tree
// with queries. The boxes find candidates in float arithmetic; our exact decision finds those that intersect.
#pragma once

#include <embree3/rtcore.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <span>

#include "core/exact/exact.h"

namespace graze::cli {

// Runs on one core.
class EmbreeTree {
 public:
  using Triangle = std::array<float, 9>;

  // Builds the tree.   Requires: finite coordinates; the triangles stay in place while the tree lives.
  explicit EmbreeTree(std::span<const Triangle> triangles) : triangles_(triangles) {
    one_core_.execute([&] { tree_ = scene_of(triangles_); });
  }
  EmbreeTree(const EmbreeTree&) = delete;
  EmbreeTree& operator=(const EmbreeTree&) = delete;
  ~EmbreeTree() {
    rtcReleaseScene(tree_);
    rtcReleaseDevice(device_);
  }

  // Returns exactly how many of the tree's triangles intersect the reference.   Requires: finite coordinates.
  std::uint64_t count(const Triangle& reference) {
    Question question{{&reference, 1}, triangles_, 0};
    one_core_.execute([&] {
      const RTCScene alone = scene_of(question.reference);
      rtcCollide(alone, tree_, &decide, &question);
      rtcReleaseScene(alone);
    });
    return question.hits;
  }

 private:
  struct Question {
    std::span<const Triangle> reference, triangles;
    std::atomic<std::uint64_t> hits;
  };

  static void decide(void* of, RTCCollision* found, unsigned count) {
    Question& question = *static_cast<Question*>(of);
    for (unsigned i = 0; i < count; ++i)
      question.hits += exact::intersects(question.reference[0].data(), question.triangles[found[i].primID1].data());
  }

  static void bounds(const RTCBoundsFunctionArguments* of) {
    const Triangle& t = (*static_cast<const std::span<const Triangle>*>(of->geometryUserPtr))[of->primID];
    RTCBounds& box = *of->bounds_o;
    box.lower_x = std::min({t[0], t[3], t[6]}), box.upper_x = std::max({t[0], t[3], t[6]});
    box.lower_y = std::min({t[1], t[4], t[7]}), box.upper_y = std::max({t[1], t[4], t[7]});
    box.lower_z = std::min({t[2], t[5], t[8]}), box.upper_z = std::max({t[2], t[5], t[8]});
  }

  RTCScene scene_of(const std::span<const Triangle>& triangles) const {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(triangles.size()));
    rtcSetGeometryUserData(geometry, const_cast<std::span<const Triangle>*>(&triangles));
    rtcSetGeometryBoundsFunction(geometry, &bounds, nullptr);
    rtcCommitGeometry(geometry);
    const RTCScene scene = rtcNewScene(device_);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    return scene;
  }

  std::span<const Triangle> triangles_;
  tbb::task_arena one_core_{1};
  RTCDevice device_ = rtcNewDevice("threads=1");
  RTCScene tree_ = nullptr;
};

}  // namespace graze::cli
