// SPDX-License-Identifier: Apache-2.0
// Properties that an algorithm declares. An algorithm is a struct with `kInfo` and a static template `decide`.
#pragma once

#include <string_view>

#include "core/epsilon_sites.h"
#include "core/vec3.h"
#include "core/verdict.h"

namespace graze {

struct AlgorithmInfo {
  std::string_view id;
  std::string_view paper;
  std::string_view coplanar;           // what its paper says about coplanar triangles
  std::string_view degenerate;         // what its paper says about segments and points
  std::string_view order;              // whether the verdict can depend on the order of triangles and vertices
  bool rounding_free_on_lattice;       // neither divides nor takes roots
  bool right_without_rounding = true;  // on all pairs of proper triangles, if every operation is exact
};

inline namespace GRAZE_FP {

GRAZE_HD inline Verdict verdict_of(bool intersects) { return intersects ? Verdict::intersects : Verdict::disjoint; }

}  // namespace GRAZE_FP
}  // namespace graze
