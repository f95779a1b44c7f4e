// SPDX-License-Identifier: Apache-2.0
// A scene's file as numbers to draw from, and which strata it cannot contain.
#pragma once

#include <optional>
#include <string>

#include "strata/scene/file.h"
#include "strata/scene/scene.h"

namespace graze::strata {

// Requires: `scene` is what parse_scene took.
Scene resolved(const SceneFile& scene);

// Why the scene cannot contain the stratum, as what follows "left out, for"; nothing where it can.
std::optional<std::string> left_out(const SceneFile& scene, Stratum stratum);

// The kind of pairs that the stratum draws in a scene.
Kind kind_of(Stratum stratum);

// The coordinate as a scene stores a number: float32.
inline double as_float32(double x) { return static_cast<double>(static_cast<float>(x)); }

}  // namespace graze::strata
