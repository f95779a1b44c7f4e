// SPDX-License-Identifier: Apache-2.0
// Turns a scene file into numbers to draw from, and says which strata the scene cannot contain.
#pragma once

#include <optional>
#include <string>

#include "strata/scene/file.h"
#include "strata/scene/scene.h"

namespace graze::strata {

// The numbers for pairs of the scene's own type.   Requires: parse_scene accepted `scene`.
Scene resolved(const SceneFile& scene);

// The scene for pairs of the given type.
// Throws: UsageError if that scene would not be valid, for example if float32 is too coarse for a scene of doubles.
SceneFile with_type(const SceneFile& scene, bool in_doubles);

// Why the scene cannot contain the stratum; nothing if it can.
std::optional<std::string> left_out(const SceneFile& scene, Stratum stratum);

// The coordinate as the scene stores it: rounded to float32, unless its coordinates are doubles.
inline double as_float32(double x) { return static_cast<double>(static_cast<float>(x)); }
inline double as_stored(const SceneFile& scene, double x) { return scene.in_doubles ? x : as_float32(x); }

// An ulp of `largest`, the largest coordinate of the scene.
double ulp_of(const SceneFile& scene, double largest);

}  // namespace graze::strata
