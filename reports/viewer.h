// SPDX-License-Identifier: Apache-2.0
// The viewer is one HTML file, in which graze.wasm or graze_f64.wasm decides a pair again after each change.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/any_pair.h"
#include "core/lanes/lanes.h"
#include "core/verdict.h"

namespace graze::reports {

// The verdict of a lane of a user's code on a pair. The page shows this verdict because it cannot run such code.
struct SaidOfPair {
  std::string lane;
  Verdict verdict;
  bool wrong;
  bool stored = false;  // whether the verdict comes from the campaign, because the code is gone
};

struct ViewedPair {
  std::string name;
  AnyPair pair;
  std::vector<SaidOfPair> said = {};
};

struct Viewed {
  std::string title;              // title of the list of pairs
  std::vector<ViewedPair> pairs;  // if empty, the special cases of 2012 are shown
  // The triangles of a mesh or a query, shown against the first triangle of a pair. If all pairs are
  // float32, the triangles must be float32 too.
  std::vector<std::array<Vec3<double>, 3>> triangles;
  std::vector<std::size_t> ids;           // ids of the triangles; if empty, they are numbered in order
  bool opens_with_triangles = false;      // show all triangles at once instead of a pair
  nlohmann::ordered_json lanes_left_out;  // lanes of a user's code, with reasons; null if there are none
  std::size_t random = 0;                 // if not 0, show this many random triangles of 2012 first
};

// Limits on the size of the page.
inline constexpr std::size_t kMostViewedPairs = 5000, kMostViewedTriangles = 5000;

// Whether this build has the viewer of reports/web, which is built with Node and a compiler for WebAssembly.
bool has_viewer();

// Returns the viewer's data for pairs of this coordinate type: its module, the evidence for the twins, and stored
// verdicts on a few hundred pairs: some from every stratum, and the canaries (cuda/twin/canaries.pairs). When the
// viewer opens, it checks itself against these verdicts. Null if the build has no viewer.
nlohmann::ordered_json viewer_parts(Scalar coordinates);

// Returns the page. If any of its pairs has doubles, all pairs are shown as doubles.
// Requires: has_viewer(); at most kMostViewedPairs pairs and kMostViewedTriangles triangles.
std::string viewer_page(const Viewed& viewed);

}  // namespace graze::reports
