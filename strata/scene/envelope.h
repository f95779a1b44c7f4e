// SPDX-License-Identifier: Apache-2.0
// Converts a scene file to the numbers used for drawing, and finds the strata that the scene cannot contain.
#pragma once

#include <optional>
#include <string>

#include "strata/scene/file.h"
#include "strata/scene/scene.h"

namespace graze::strata {

// The numbers for pairs of the scene's own coordinate type.   Requires: `scene` comes from parse_scene.
Scene resolved(const SceneFile& scene);

// The same scene for pairs of the given type.
// Throws: UsageError if that scene would not be valid, for example if float32 is too coarse for a scene of doubles.
SceneFile with_type(const SceneFile& scene, bool in_doubles);

// Why the scene cannot contain the stratum; nothing if it can.
std::optional<std::string> left_out(const SceneFile& scene, Stratum stratum);

// The coordinate as the scene stores it: rounded to float32, unless the scene's coordinates are doubles.
inline double as_float32(double x) { return static_cast<double>(static_cast<float>(x)); }
inline double as_stored(const SceneFile& scene, double x) { return scene.in_doubles ? x : as_float32(x); }

// An ulp of `largest`, the scene's largest coordinate.
double ulp_of(const SceneFile& scene, double largest);

}  // namespace graze::strata
