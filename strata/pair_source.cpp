// SPDX-License-Identifier: Apache-2.0
#include "strata/pair_source.h"

#include <algorithm>
#include <span>

#include "core/error.h"
#include "core/lanes/lanes.h"
#include "core/text.h"
#include "strata/strata.h"

namespace graze::strata {

namespace {

PairSource source_of(std::uint64_t seed, const StratumInfo& row) {
  return {std::string(row.id),
          0,
          [seed, stratum = row.stratum](std::uint64_t index) { return generate(seed, stratum, index); },
          static_cast<int>(row.stratum),
          row.axis,
          seed};
}

Axis wide(Axis axis) { return axis == Axis::scale ? Axis::wide_scale : axis; }

#ifdef __wasm__  // test_function.cpp draws only float32
PairSource double_source_of(std::uint64_t, const StratumInfo& row) {
  throw UsageError("this build does not draw " + std::string(row.id) + std::string(kInDoubles));
}
#else
PairSource double_source_of(std::uint64_t seed, const StratumInfo& row) {
  PairSource source{std::string(row.id) + std::string(kInDoubles), 0, nullptr, -1, wide(row.axis), seed};
  if (is_drawn_on_devices(row.stratum)) source.stratum = static_cast<int>(row.stratum);
  source.double_pair = [seed, stratum = row.stratum](std::uint64_t index) {
    return generate_doubles(seed, stratum, index);
  };
  return source;
}
#endif

void share_evenly(std::vector<PairSource>& sources, std::uint64_t pairs) {
  for (std::size_t s = 0; s < sources.size(); ++s)
    sources[s].pairs = pairs / sources.size() + (s < pairs % sources.size());
}

}  // namespace

PairBlock pairs_of(const PairSource& source, std::uint64_t first, std::uint64_t count) {
  PairBlock block;
  for (std::uint64_t i = first; i < first + count; ++i) {
    if (source.in_doubles()) block.doubles.push_back(source.double_pair(i));
    block.floats.push_back(source.in_doubles() ? stored_in_float32(block.doubles.back()) : source.pair(i));
  }
  return block;
}

void expect_float32(std::span<const PairSource> sources, const char* verb) {
  for (const PairSource& source : sources) {
    if (source.in_doubles())
      throw UsageError("`graze " + std::string(verb) + "` takes only pairs of float32, but " + source.id +
                       " has pairs of doubles");
  }
}

const StratumInfo* stratum_info(std::string_view source) {
  const std::optional<std::string_view> in_doubles = stratum_in_doubles(source);
  const std::span<const StratumInfo> rows = strata_of(in_doubles.has_value());
  const auto row =
      std::find_if(rows.begin(), rows.end(), [&](const StratumInfo& s) { return s.id == in_doubles.value_or(source); });
  return row == rows.end() ? nullptr : &*row;
}

Axis axis_of(std::string_view source) {
  const StratumInfo* row = stratum_info(source);
  return !row ? Axis::none : stratum_in_doubles(source) ? wide(row->axis) : row->axis;
}

std::vector<std::string> source_patterns(const std::vector<std::string>& globs, const std::vector<std::string>& ids,
                                         const std::string& more) {
  std::vector<std::string> patterns = globs;
  for (const std::string& glob : globs) {
    patterns.push_back(glob + std::string(kInDoubles));
    const std::string wanted = glob.substr(glob.starts_with('!'));
    const std::vector<std::string> either = {wanted, wanted + std::string(kInDoubles)};
    if (std::none_of(ids.begin(), ids.end(), [&](const std::string& id) { return matches_any(either, id); }))
      throw UsageError("no stratum matches '" + printable(glob) + "'; `graze strata` lists them" + more +
                       did_you_mean(glob, ids));
  }
  if (std::none_of(ids.begin(), ids.end(), [&](const std::string& id) { return matches_any(patterns, id); })) {
    std::string names;
    for (const std::string& glob : globs) names += (names.empty() ? "" : ",") + glob;
    throw UsageError("the patterns \"" + printable(names) + "\" leave no stratum; `graze strata` lists all strata");
  }
  return patterns;
}

std::vector<PairSource> stratum_sources(std::uint64_t seed, std::uint64_t pairs, const std::vector<std::string>& globs,
                                        PairTypes types) {
  std::vector<PairSource> all;
  if (types != PairTypes::f64) {
    for (const StratumInfo& row : kStrata) all.push_back(source_of(seed, row));
  }
  if (types != PairTypes::f32) {
    for (const StratumInfo& row : kDoubleStrata) all.push_back(double_source_of(seed, row));
  }
  std::vector<std::string> ids;
  for (const PairSource& source : all) ids.push_back(source.id);
  const std::vector<std::string> patterns = source_patterns(globs, ids);
  std::erase_if(all, [&](const PairSource& source) { return !matches_any(patterns, source.id); });
  share_evenly(all, pairs);
  return all;
}

std::vector<PairSource> named_sources(std::uint64_t seed, std::uint64_t pairs, const std::vector<std::string>& names) {
  std::vector<PairSource> sources;
  for (const std::string& name : names) {
    const StratumInfo* row = stratum_info(name);
    if (!row) throw UsageError("there is no stratum '" + printable(name) + "'; `graze strata` lists them");
    sources.push_back(stratum_in_doubles(name) ? double_source_of(seed, *row) : source_of(seed, *row));
  }
  share_evenly(sources, pairs);
  return sources;
}

}  // namespace graze::strata
