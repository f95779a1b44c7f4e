// SPDX-License-Identifier: Apache-2.0
// Groups of strata. Results are reported by group, because a lane's results on general pairs do not predict its results
// on coplanar pairs.
#pragma once

#include <optional>
#include <string_view>

#include "strata/pair_source.h"
#include "strata/strata.h"

namespace graze::strata {

struct GroupInfo {
  Group group;
  std::string_view id;
  std::string_view what;
};

// One row for each group, in the order of the enumerators.
inline constexpr GroupInfo kGroups[] = {
    {Group::general, "general",
     "strata of triangles of usual shape and size, with near and exact contacts; some pairs lie in parallel planes, "
     "and some are degenerate"},
    {Group::coplanar, "coplanar",
     "triangles in one plane, nearly in one plane, or in parallel planes; some small ones pierce a larger one"},
    {Group::degenerate, "degenerate", "segments and points in place of triangles, often or always"},
    {Group::extreme, "extreme",
     "needles, coordinates of extreme or very different sizes, and pairs far from the origin"},
    {Group::mesh, "mesh", "pairs of a mesh's triangles whose boxes overlap"},
};

// The group of the campaign source with this name: a stratum, or a source of a mesh's pairs. Nothing if this build does
// not know the name.
constexpr std::optional<Group> group_of_name(std::string_view id) {
  const std::string_view stratum = stratum_in_doubles(id).value_or(id);
  for (const StratumInfo& row : kDoubleStrata) {
    if (row.id == stratum) return row.group;
  }
  return stratum == "mesh" || id.starts_with("mesh_") ? std::optional(Group::mesh) : std::nullopt;
}

}  // namespace graze::strata
