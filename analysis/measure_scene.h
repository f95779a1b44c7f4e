// SPDX-License-Identifier: Apache-2.0
// Measures a scene file from real triangles and pairs, so that nobody has to write it by hand.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/pair.h"
#include "strata/scene/file.h"

namespace graze::analysis {

template <class Real>
struct BasicSceneSample {
  std::vector<std::array<Vec3<Real>, 3>> triangles;  // all finite
  std::uint64_t pairs = 0;                           // number of pairs whose boxes overlap
  std::function<BasicPair<Real>(std::uint64_t index)> pair;
};
using SceneSample = BasicSceneSample<float>;
using DoubleSceneSample = BasicSceneSample<double>;

// A sample with the pairs whose closed boxes overlap, and with the triangles of all pairs.
template <class Real>
BasicSceneSample<Real> sample_of(const std::vector<BasicPair<Real>>& pairs);

inline constexpr int kSceneQuantiles = 17;
inline constexpr std::uint64_t kSceneSample = 1 << 18;  // larger samples are thinned to evenly spaced pairs

// Measures extent, sizes to six digits, the grid if there is evidence of one, kinds of pairs, and exact margins. The
// scene has the type of the sample.
// Throws: std::runtime_error if all triangles are degenerate, if there are no pairs, or if a coordinate exceeds 2^126.
template <class Real>
strata::SceneFile measure_scene(const BasicSceneSample<Real>& sample, const std::string& name);

}  // namespace graze::analysis
