// SPDX-License-Identifier: Apache-2.0
// Turns a scene's file into numbers to draw from, and tells which strata the scene cannot contain.
#pragma once

#include <optional>
#include <string>

#include "strata/scene/file.h"
#include "strata/scene/scene.h"

namespace graze::strata {

// Requires: parse_scene accepted `scene`.
Scene resolved(const SceneFile& scene);

// Why the scene cannot contain the stratum, worded to follow "left out, for"; nothing if it can.
std::optional<std::string> left_out(const SceneFile& scene, Stratum stratum);

// The kind of pairs that the stratum draws in a scene.
Kind kind_of(Stratum stratum);

// The coordinate rounded to float32, as a scene stores it.
inline double as_float32(double x) { return static_cast<double>(static_cast<float>(x)); }

}  // namespace graze::strata
