// SPDX-License-Identifier: Apache-2.0
// Where a campaign's pairs come from: a stratum, or a mesh's candidate pairs; each a pure function of an index.
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
  std::uint64_t pairs = 0;  // how many of them the campaign takes: indices [0, pairs)
  std::function<Pair(std::uint64_t index)> pair;
  // What draws the same pairs on a device: a stratum's place in kStrata; -1: only `pair` draws them.
  int stratum = -1;
  Axis axis = Axis::none;  // the stratum's
  std::uint64_t seed = 0;
  std::shared_ptr<const Scene> scene = nullptr;  // that the stratum is drawn in; null: in none
};

// The strata whose names match (all of them for an empty list), `pairs` shared evenly, the first ones taking the rest.
// Throws: UsageError when a pattern matches none.
std::vector<PairSource> stratum_sources(std::uint64_t seed, std::uint64_t pairs, const std::vector<std::string>& globs);

}  // namespace graze::strata
