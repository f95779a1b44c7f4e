// SPDX-License-Identifier: Apache-2.0
// The viewer: one HTML file in which graze.wasm decides the pairs anew while they are changed.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/pair.h"

namespace graze::reports {

struct ViewedPair {
  std::string name;
  Pair pair;
};

struct Viewed {
  std::string title;              // of the pairs' list
  std::vector<ViewedPair> pairs;  // none: the special cases of 2012
  std::vector<std::array<Vec3<float>, 3>>
      triangles;                      // of a mesh or a query, to be seen against the first triangle of a pair
  bool opens_with_triangles = false;  // all of them at once, rather than a pair
};

// What keeps the page small.
inline constexpr std::size_t kMostViewedPairs = 5000, kMostViewedTriangles = 5000;

// Whether this build has the page of reports/web, which takes Node and a compiler for WebAssembly.
bool has_viewer();

// What the viewer takes beside what it shows: the stored verdicts of some hundred pairs by which it checks itself when
// it opens, of every stratum and the canaries (cuda/twin/canaries.pairs), and the evidence of the twins. Null without
// it.
nlohmann::ordered_json viewer_checks();

// The page.   Requires: has_viewer(); no more pairs and triangles than the most.
std::string viewer_page(const Viewed& viewed);

}  // namespace graze::reports
