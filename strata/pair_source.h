// SPDX-License-Identifier: Apache-2.0
// Where a campaign's pairs come from: a stratum, or a mesh's candidate pairs. Each is a pure function of an index.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/margin/axis.h"
#include "core/pair.h"

namespace graze::strata {

struct Scene;

struct PairSource {
  std::string id;
  std::uint64_t pairs = 0;  // the campaign takes the indices [0, pairs)
  std::function<Pair(std::uint64_t index)> pair;
  // For drawing the same pairs on a device: the stratum's index in kStrata; -1 if only `pair` can draw them.
  int stratum = -1;
  Axis axis = Axis::none;  // the stratum's
  std::uint64_t seed = 0;
  std::shared_ptr<const Scene> scene = nullptr;  // the scene in which the stratum is drawn; null: none
};

// The strata whose names match (all for an empty list). They share `pairs` evenly; the first ones take the remainder.
// Throws: UsageError if a pattern matches no stratum, or if all together leave none.
std::vector<PairSource> stratum_sources(std::uint64_t seed, std::uint64_t pairs, const std::vector<std::string>& globs);

}  // namespace graze::strata
