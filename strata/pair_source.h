// SPDX-License-Identifier: Apache-2.0
// The sources of a campaign's pairs: strata, and meshes' candidate pairs. A source is a pure function of the index.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/any_pair.h"
#include "core/margin/axis.h"

namespace graze::strata {

struct Scene;
struct StratumInfo;

struct PairSource {
  std::string id;
  std::uint64_t pairs = 0;                        // the campaign takes the indices [0, pairs)
  std::function<Pair(std::uint64_t index)> pair;  // null if the coordinates are doubles
  // The stratum from which a device can draw the same pairs; -1 if only `pair` or `double_pair` can draw them.
  int stratum = -1;
  Axis axis = Axis::none;  // what else the stratum varies, besides the margin
  std::uint64_t seed = 0;
  std::shared_ptr<const Scene> scene = nullptr;  // the scene in which the stratum is drawn, or null
  std::function<DoublePair(std::uint64_t index)> double_pair = nullptr;  // for doubles, in place of `pair`

  bool in_doubles() const { return bool(double_pair); }
  AnyPair any_pair(std::uint64_t index) const { return in_doubles() ? AnyPair(double_pair(index)) : pair(index); }
};

// Pairs of one type. For doubles, `floats` holds the pairs rounded to float32, which single-precision lanes decide.
struct PairBlock {
  std::vector<Pair> floats;
  std::vector<DoublePair> doubles;  // empty for float32 pairs

  bool in_doubles() const { return !doubles.empty(); }
  std::size_t size() const { return floats.size(); }
  AnyPair operator[](std::size_t i) const { return in_doubles() ? AnyPair(doubles[i]) : floats[i]; }
};

PairBlock pairs_of(const PairSource& source, std::uint64_t first, std::uint64_t count);

// The suffix of sources of doubles, such as "uniform/f64". stratum_in_doubles returns the stratum of such a source, and
// nothing for a float32 source.
inline constexpr std::string_view kInDoubles = "/f64";
constexpr std::optional<std::string_view> stratum_in_doubles(std::string_view source) {
  if (!source.ends_with(kInDoubles)) return std::nullopt;
  return source.substr(0, source.size() - kInDoubles.size());
}

// Throws: UsageError that names the verb if a source has pairs of doubles.
void expect_float32(std::span<const PairSource> sources, const char* verb);

// The row of the stratum with this name, of either type; null if there is none.
const StratumInfo* stratum_info(std::string_view source);
Axis axis_of(std::string_view source);

// The patterns that select sources among `ids`: each glob, and the glob with "/f64" appended, which matches the same
// strata in doubles.
// more: sources other than strata, for the message.
// Throws: UsageError if a glob matches no source, or if the globs together select none.
std::vector<std::string> source_patterns(const std::vector<std::string>& globs, const std::vector<std::string>& ids,
                                         const std::string& more = "");

// The strata whose names match; all strata for an empty list. The strata share `pairs` evenly; the first ones get the
// remainder. Throws: the errors of source_patterns.
std::vector<PairSource> stratum_sources(std::uint64_t seed, std::uint64_t pairs, const std::vector<std::string>& globs,
                                        PairTypes types = PairTypes::f32);

// Like stratum_sources, for the strata with exactly these names, of both types.
std::vector<PairSource> named_sources(std::uint64_t seed, std::uint64_t pairs, const std::vector<std::string>& names);

}  // namespace graze::strata
