// SPDX-License-Identifier: Apache-2.0
#include "strata/scene/envelope.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace graze::strata {
namespace {

// Fills the gaps between the file's quantiles by repeatedly inserting two neighbours' geometric mean. Geometric means
// need only square roots, which are the same on every machine.
Quantiles spread(const std::vector<double>& values) {
  Quantiles quantiles{};
  if (values.size() == 1) {
    std::fill(std::begin(quantiles.at), std::end(quantiles.at), values[0]);
    return quantiles;
  }
  std::size_t step = (kQuantiles - 1) / (values.size() - 1);
  for (std::size_t i = 0; i < values.size(); ++i) quantiles.at[i * step] = values[i];
  for (; step > 1; step /= 2) {
    for (std::size_t i = 0; i + step < kQuantiles; i += step) {
      const double low = quantiles.at[i], high = quantiles.at[i + step];
      quantiles.at[i + step / 2] = std::clamp(std::sqrt(low) * std::sqrt(high), low, high);
    }
  }
  return quantiles;
}

double largest_of(const SceneFile& scene) {
  double largest = 0;
  for (const auto& [low, high] : scene.extent)
    largest = std::max({largest, std::fabs(as_stored(scene, low)), std::fabs(as_stored(scene, high))});
  return largest;
}

// Limits for a scene's longest edges, in steps of the exact grid: at least kLeastSteps for an exact stratum, and at
// most kMostLatticeSteps for `lattice`. For mixed_scale and nested, the edges' lengths must differ by a factor of at
// least kLeastFactor.
constexpr double kLeastSteps = 64, kMostLatticeSteps = 64, kLeastFactor = 16;

double longest_in_steps(const SceneFile& scene, const Grid& grid) {
  return grid.decimal ? scene.edges.back() * grid.scale : scene.edges.back() / grid.scale;
}

std::string coordinates_stay_within(const SceneFile& scene) {
  double low = scene.extent[0][0], high = scene.extent[0][1];
  for (const auto& axis : scene.extent) {
    low = std::min(low, axis[0]);
    high = std::max(high, axis[1]);
  }
  return fmt::format("your coordinates stay within {} … {} {}", low, high, scene.units);
}

// The index n of the grid point nearest to x, which may be off by one if it is 2^51 or more.
double number_at(const Grid& grid, double x) {
  const double steps = grid.decimal ? x * grid.scale : x / grid.scale;
  return std::fabs(steps) < 0x1p51 ? in_scene::number_of(grid, x) : std::trunc(steps);
}

}  // namespace

double ulp_of(const SceneFile& scene, double largest) {
  return std::ldexp(
      1.0, scene.in_doubles ? std::max(floor_log2(largest) - 52, -1074) : std::max(floor_log2(largest) - 23, -149));
}

SceneFile with_type(const SceneFile& scene, bool in_doubles) {
  if (scene.in_doubles == in_doubles) return scene;
  SceneFile other = scene;
  other.in_doubles = in_doubles;
  try {
    parse_scene("", scene_text(other));
  } catch (const std::runtime_error& error) {
    const std::string what = error.what();
    throw UsageError(fmt::format("cannot draw pairs of {} in a scene of {}{}; draw pairs of the scene's own type",
                                 in_doubles ? "doubles" : "float32", in_doubles ? "float32" : "doubles",
                                 what.substr(what.find(": "))));
  }
  return other;
}

Scene resolved(const SceneFile& file) {
  Scene scene{};
  scene.edges = spread(file.edges);
  scene.aspect = spread(file.aspect);
  scene.exact = {ulp_of(file, largest_of(file)), false};
  if (file.grid) {
    scene.on_grid = true;
    double scale = 1;
    for (int i = 0; i < file.grid->places && file.grid->decimal; ++i) scale *= 10;
    scene.grid = file.grid->decimal ? Grid{scale, true} : Grid{std::ldexp(1.0, file.grid->places), false};
    if (file.grid->decimal || scene.grid.scale > scene.exact.scale) scene.exact = scene.grid;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const auto& [from, to] = file.extent[static_cast<std::size_t>(axis)];
    double low = as_stored(file, from), high = as_stored(file, to);
    // The first and last grid points within [low, high] after rounding to the stored type.
    const auto first_on = [&](const Grid& grid) {
      const double n = number_at(grid, low);
      return as_stored(file, in_scene::point_of(grid, n)) < low ? n + 1 : n;
    };
    const auto last_on = [&](const Grid& grid) {
      const double n = number_at(grid, high);
      return as_stored(file, in_scene::point_of(grid, n)) > high ? n - 1 : n;
    };
    component(scene.first, axis) = first_on(scene.exact);
    component(scene.last, axis) = last_on(scene.exact);
    if (scene.on_grid) {
      const double n = first_on(scene.grid), m = last_on(scene.grid);
      low = in_scene::point_of(scene.grid, n);
      high = in_scene::point_of(scene.grid, m);
    }
    component(scene.low, axis) = low;
    component(scene.high, axis) = high;
  }
  return scene;
}

std::optional<std::string> left_out(const SceneFile& scene, Stratum stratum) {
  const Scene numbers = resolved(scene);
  const double steps = longest_in_steps(scene, numbers.exact);
  const double factor = scene.edges.back() / scene.edges.front();
  switch (stratum) {
    case Stratum::thesis:
    case Stratum::thesis_special:
      return "its triangles have fixed coordinates, not those of a scene";
    case Stratum::lattice_15:
    case Stratum::float_born:
    case Stratum::decimal_born:
    case Stratum::construction_born:
    case Stratum::stored:
      return "its triangles have their own sizes, not those of a scene";
    case Stratum::far_from_origin:
    case Stratum::large_offset:
    case Stratum::radians:
      return coordinates_stay_within(scene);
    case Stratum::extreme_scale:
      return fmt::format("{}, and your triangles' longest edges within {} … {}", coordinates_stay_within(scene),
                         scene.edges.front(), scene.edges.back());
    case Stratum::mixed_scale:
    case Stratum::nested:
      if (factor < kLeastFactor)
        return fmt::format("your triangles' longest edges differ by a factor of {:.3g}, less than {}", factor,
                           kLeastFactor);
      break;
    case Stratum::sliver:
      if (scene.aspect.back() < in_scene::kSliver)
        return fmt::format("your aspect ratios stay within {} … {}, below {}", scene.aspect.front(),
                           scene.aspect.back(), in_scene::kSliver);
      break;
    case Stratum::exact_contact:
    case Stratum::coplanar_wide:
      if (steps < kLeastSteps)
        return fmt::format("your longest edge spans {:.3g} {}, fewer than {}", steps,
                           scene.grid ? "grid steps" : "ulps of your largest coordinate", kLeastSteps);
      for (int axis = 0; axis < 3; ++axis) {
        if (component(numbers.first, axis) > component(numbers.last, axis))
          return fmt::format("your extent contains no multiple of {} (one ulp of your largest coordinate) along {}",
                             numbers.exact.scale, "xyz"[axis]);
      }
      break;
    case Stratum::lattice:
      if (!scene.grid) return "your scene has no grid";
      if (steps > kMostLatticeSteps)
        return fmt::format("your longest edge spans {:.3g} grid steps, more than {}", steps, kMostLatticeSteps);
      break;
    default:
      break;
  }
  const auto row = std::find_if(std::begin(kDoubleStrata), std::end(kDoubleStrata),
                                [&](const StratumInfo& info) { return info.stratum == stratum; });
  if (row == std::end(kDoubleStrata)) return std::nullopt;
  const auto kind = static_cast<std::size_t>(row->kind);
  if (scene.mix[kind] == 0) return fmt::format("your mix has no pairs of the kind {}", kKindIds[kind]);
  return std::nullopt;
}

}  // namespace graze::strata
