// SPDX-License-Identifier: Apache-2.0
#include "analysis/measure_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "core/cannot.h"
#include "oracle/truth.h"

namespace graze::analysis {
namespace {

using strata::GridSpec;
using strata::Kind;
using Triangle = std::array<Vec3<float>, 3>;

double six_digits(double x) { return std::strtod(fmt::format("{:.6g}", x).c_str(), nullptr); }

// The shortest decimal that float32 stores as x, as a person would write it.
double as_written(double x) {
  const auto stored = static_cast<float>(x);
  const double shortest = std::strtod(fmt::format("{}", stored).c_str(), nullptr);
  return static_cast<float>(shortest) == stored ? shortest : x;
}

Vec3<double> wide(const Vec3<float>& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

double length(const Vec3<double>& v) { return std::sqrt(dot(v, v)); }

bool is_degenerate(const Triangle& t) {
  return oracle::hulls({{t[0], t[1], t[2]}, {t[0], t[1], t[2]}}).dimension_a < 2;
}

std::vector<double> quantiles_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  std::vector<double> quantiles;
  for (std::size_t q = 0; q < kSceneQuantiles; ++q)
    quantiles.push_back(six_digits(values[(values.size() - 1) * q / (kSceneQuantiles - 1)]));
  return quantiles;
}

void measure_sizes(const std::vector<Triangle>& triangles, const std::string& name, strata::SceneFile& scene) {
  std::vector<double> edges, aspect;
  for (const Triangle& t : triangles) {
    const Vec3<double> a = wide(t[0]), b = wide(t[1]), c = wide(t[2]);
    const double longest = std::max({length(b - a), length(c - b), length(a - c)});
    const double area2 = length(cross(b - a, c - a));
    if (!(area2 > 1e-9 * longest * longest) && is_degenerate(t)) continue;
    edges.push_back(longest);
    aspect.push_back(std::clamp(longest * longest / area2, 1.1547005, 1e12));  // a sliver whose area rounds to 0
  }
  if (edges.empty()) throw std::runtime_error(cannot("measure", name, "all triangles are degenerate"));
  scene.edges = quantiles_of(std::move(edges));
  scene.aspect = quantiles_of(std::move(aspect));
}

// If a coordinate has room for n bits below the grid, it lies on the grid by chance once in 2^n times. The grid is
// accepted if these n add up to at least kEvidence bits.
constexpr double kEvidence = 128;

// The distinct absolute values of all coordinates, without 0.
std::vector<float> values_of(const std::vector<Triangle>& triangles) {
  std::vector<float> values;
  for (const Triangle& t : triangles) {
    for (const Vec3<float>& v : t) {
      for (int axis = 0; axis < 3; ++axis) values.push_back(std::fabs(component(v, axis)));
    }
  }
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  if (!values.empty() && values[0] == 0) values.erase(values.begin());
  return values;
}

double ulp_of(float x) { return static_cast<double>(std::nextafterf(x, INFINITY)) - static_cast<double>(x); }

std::optional<GridSpec> grid_of(const std::vector<float>& values) {
  const auto is_evident = [&](double step) {
    if (static_cast<double>(values.back()) / step > 0x1p48) return false;  // the most that a scene accepts
    double bits = 0;
    for (const float x : values) bits += std::max(std::floor(std::log2(step / ulp_of(x))), 0.0);
    return bits >= kEvidence;
  };
  if (values.empty()) return std::nullopt;
  int places = 127;
  for (const float x : values) {
    int exponent;
    const auto digits = static_cast<std::uint32_t>(std::ldexp(std::frexp(x, &exponent), 24));
    places = std::min(places, exponent - 24 + __builtin_ctz(digits));
  }
  if (places <= 126 && is_evident(std::ldexp(1.0, places))) return GridSpec{false, places};
  double scale = 1;
  for (int decimals = 0; decimals <= 9; ++decimals, scale *= 10) {
    const bool all = std::all_of(values.begin(), values.end(), [&](float x) {
      return static_cast<float>(std::nearbyint(static_cast<double>(x) * scale) / scale) == x;
    });
    if (all) return is_evident(1 / scale) ? std::optional(GridSpec{true, decimals}) : std::nullopt;
  }
  return std::nullopt;
}

Kind kind_of(const Pair& pair, const Hulls& hulls) {
  if (hulls.dimension_a < 2 || hulls.dimension_b < 2) return Kind::degenerate;
  int shared = 0;
  for (const Vec3<float>& u : pair.a)
    shared += std::any_of(std::begin(pair.b), std::end(pair.b), [&](const Vec3<float>& v) { return u == v; });
  return shared == 2      ? Kind::shared_edge
         : shared == 1    ? Kind::shared_vertex
         : hulls.coplanar ? Kind::coplanar
                          : Kind::general;
}

void measure_pairs(const SceneSample& sample, strata::SceneFile& scene) {
  const std::uint64_t count = std::min(sample.pairs, kSceneSample);
  std::array<std::uint64_t, strata::kKinds> kinds{};
  std::map<Bucket, std::uint64_t> margins;
  for (std::uint64_t i = 0; i < count; ++i) {
    const Pair pair = sample.pair(i * (sample.pairs / count));
    ++kinds[static_cast<std::size_t>(kind_of(pair, oracle::hulls(pair)))];
    ++margins[oracle::margin_bucket(pair, oracle::cgal_verdict(pair))];
  }
  const auto share = [&](std::uint64_t n) { return six_digits(static_cast<double>(n) / static_cast<double>(count)); };
  for (std::size_t kind = 0; kind < strata::kKinds; ++kind) scene.mix[kind] = share(kinds[kind]);
  for (const auto& [bucket, n] : margins) scene.margins[bucket] = share(n);
}

}  // namespace

SceneSample sample_of(const std::vector<Pair>& pairs) {
  SceneSample sample;
  std::vector<Pair> overlapping;
  for (const Pair& pair : pairs) {
    sample.triangles.push_back({pair.a[0], pair.a[1], pair.a[2]});
    sample.triangles.push_back({pair.b[0], pair.b[1], pair.b[2]});
    bool apart = false;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = std::minmax({component(pair.a[0], axis), component(pair.a[1], axis), component(pair.a[2], axis)});
      const auto b = std::minmax({component(pair.b[0], axis), component(pair.b[1], axis), component(pair.b[2], axis)});
      apart = apart || a.second < b.first || b.second < a.first;
    }
    if (!apart) overlapping.push_back(pair);
  }
  sample.pairs = overlapping.size();
  sample.pair = [overlapping = std::move(overlapping)](std::uint64_t index) {
    return overlapping[static_cast<std::size_t>(index)];
  };
  return sample;
}

strata::SceneFile measure_scene(const SceneSample& sample, const std::string& name) {
  if (sample.pairs == 0) throw std::runtime_error(cannot("measure", name, "no two triangles have boxes that overlap"));
  strata::SceneFile scene;
  for (std::size_t axis = 0; axis < 3; ++axis) scene.extent[axis] = {INFINITY, -INFINITY};
  for (const Triangle& t : sample.triangles) {
    for (const Vec3<float>& v : t) {
      for (int axis = 0; axis < 3; ++axis) {
        auto& [low, high] = scene.extent[static_cast<std::size_t>(axis)];
        low = std::min(low, static_cast<double>(component(v, axis)));
        high = std::max(high, static_cast<double>(component(v, axis)));
      }
    }
  }
  for (auto& [low, high] : scene.extent) {
    if (std::max(-low, high) > 0x1p126)
      throw std::runtime_error(
          cannot("measure", name, fmt::format("coordinates go from {} to {}, beyond 2^126", low, high)));
    low = as_written(low);
    high = as_written(high);
  }
  measure_sizes(sample.triangles, name, scene);
  scene.grid = grid_of(values_of(sample.triangles));
  measure_pairs(sample, scene);
  return scene;
}

}  // namespace graze::analysis
