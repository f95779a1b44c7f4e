// SPDX-License-Identifier: Apache-2.0
#include "analysis/measure_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include "core/cannot.h"
#include "oracle/truth.h"

namespace graze::analysis {
namespace {

using strata::GridSpec;
using strata::Kind;
template <class Real>
using Triangle = std::array<Vec3<Real>, 3>;

double six_digits(double x) { return std::strtod(fmt::format("{:.6g}", x).c_str(), nullptr); }

// The shortest decimal that is stored as x.
template <class Real>
double as_written(double x) {
  const auto stored = static_cast<Real>(x);
  const double shortest = std::strtod(fmt::format("{}", stored).c_str(), nullptr);
  return static_cast<Real>(shortest) == stored ? shortest : x;
}

template <class Real>
Vec3<double> wide(const Vec3<Real>& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

double length(const Vec3<double>& v) { return std::sqrt(dot(v, v)); }

template <class Real>
bool is_degenerate(const Triangle<Real>& t) {
  return oracle::hulls(BasicPair<Real>{{t[0], t[1], t[2]}, {t[0], t[1], t[2]}}).dimension_a < 2;
}

std::vector<double> quantiles_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  std::vector<double> quantiles;
  for (std::size_t q = 0; q < kSceneQuantiles; ++q)
    quantiles.push_back(six_digits(values[(values.size() - 1) * q / (kSceneQuantiles - 1)]));
  return quantiles;
}

template <class Real>
void measure_sizes(const std::vector<Triangle<Real>>& triangles, const std::string& name, strata::SceneFile& scene) {
  std::vector<double> edges, aspect;
  for (const Triangle<Real>& t : triangles) {
    const Vec3<double> a = wide(t[0]), b = wide(t[1]), c = wide(t[2]);
    const double longest = std::max({length(b - a), length(c - b), length(a - c)});
    const double area2 = length(cross(b - a, c - a));
    if (!(area2 > 1e-9 * longest * longest) && is_degenerate(t)) continue;
    edges.push_back(longest);
    aspect.push_back(std::clamp(longest * longest / area2, 1.1547005, 1e12));  // a sliver's area may round to 0
  }
  if (edges.empty()) throw std::runtime_error(cannot("measure", name, "all triangles are degenerate"));
  scene.edges = quantiles_of(std::move(edges));
  scene.aspect = quantiles_of(std::move(aspect));
}

// A coordinate with n bits below the grid's step lies on the grid by chance with probability 2^-n. The grid is accepted
// if these n sum to at least kEvidence.
constexpr double kEvidence = 128;

// The distinct absolute values of all coordinates, without 0.
template <class Real>
std::vector<Real> values_of(const std::vector<Triangle<Real>>& triangles) {
  std::vector<Real> values;
  for (const Triangle<Real>& t : triangles) {
    for (const Vec3<Real>& v : t) {
      for (int axis = 0; axis < 3; ++axis) values.push_back(std::fabs(component(v, axis)));
    }
  }
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  if (!values.empty() && values[0] == 0) values.erase(values.begin());
  return values;
}

template <class Real>
double ulp_of(Real x) {
  return static_cast<double>(std::nextafter(x, std::numeric_limits<Real>::infinity())) - static_cast<double>(x);
}

template <class Real>
std::optional<GridSpec> grid_of(const std::vector<Real>& values) {
  const auto is_evident = [&](double step) {
    if (static_cast<double>(values.back()) / step > 0x1p48) return false;  // the limit for scenes
    double bits = 0;
    for (const Real x : values) bits += std::max(std::floor(std::log2(step / ulp_of(x))), 0.0);
    return bits >= kEvidence;
  };
  if (values.empty()) return std::nullopt;
  constexpr int kDigits = std::numeric_limits<Real>::digits;
  int places = 127;
  for (const Real x : values) {
    int exponent;
    const auto digits = static_cast<std::uint64_t>(std::ldexp(std::frexp(x, &exponent), kDigits));
    places = std::min(places, exponent - kDigits + std::countr_zero(digits));
  }
  if (-149 <= places && places <= 126 && is_evident(std::ldexp(1.0, places))) return GridSpec{false, places};
  double scale = 1;
  for (int decimals = 0; decimals <= 9; ++decimals, scale *= 10) {
    const bool all = std::all_of(values.begin(), values.end(), [&](Real x) {
      return static_cast<Real>(std::nearbyint(static_cast<double>(x) * scale) / scale) == x;
    });
    if (all) return is_evident(1 / scale) ? std::optional(GridSpec{true, decimals}) : std::nullopt;
  }
  return std::nullopt;
}

template <class Real>
Kind kind_of(const BasicPair<Real>& pair, const Hulls& hulls) {
  if (hulls.dimension_a < 2 || hulls.dimension_b < 2) return Kind::degenerate;
  int shared = 0;
  for (const Vec3<Real>& u : pair.a)
    shared += std::any_of(std::begin(pair.b), std::end(pair.b), [&](const Vec3<Real>& v) { return u == v; });
  return shared == 2      ? Kind::shared_edge
         : shared == 1    ? Kind::shared_vertex
         : hulls.coplanar ? Kind::coplanar
                          : Kind::general;
}

template <class Real>
void measure_pairs(const BasicSceneSample<Real>& sample, strata::SceneFile& scene) {
  const std::uint64_t count = std::min(sample.pairs, kSceneSample);
  std::array<std::uint64_t, strata::kKinds> kinds{};
  std::map<Bucket, std::uint64_t> margins;
  for (std::uint64_t i = 0; i < count; ++i) {
    const BasicPair<Real> pair = sample.pair(i * (sample.pairs / count));
    ++kinds[static_cast<std::size_t>(kind_of(pair, oracle::hulls(pair)))];
    ++margins[oracle::margin_bucket(pair, oracle::cgal_verdict(pair))];
  }
  const auto share = [&](std::uint64_t n) { return six_digits(static_cast<double>(n) / static_cast<double>(count)); };
  for (std::size_t kind = 0; kind < strata::kKinds; ++kind) scene.mix[kind] = share(kinds[kind]);
  for (const auto& [bucket, n] : margins) scene.margins[bucket] = share(n);
}

}  // namespace

template <class Real>
BasicSceneSample<Real> sample_of(const std::vector<BasicPair<Real>>& pairs) {
  BasicSceneSample<Real> sample;
  std::vector<BasicPair<Real>> overlapping;
  for (const BasicPair<Real>& pair : pairs) {
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

template <class Real>
strata::SceneFile measure_scene(const BasicSceneSample<Real>& sample, const std::string& name) {
  if (sample.pairs == 0) throw std::runtime_error(cannot("measure", name, "no two triangles have boxes that overlap"));
  strata::SceneFile scene;
  scene.in_doubles = std::is_same_v<Real, double>;
  for (std::size_t axis = 0; axis < 3; ++axis) scene.extent[axis] = {INFINITY, -INFINITY};
  for (const Triangle<Real>& t : sample.triangles) {
    for (const Vec3<Real>& v : t) {
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
    low = as_written<Real>(low);
    high = as_written<Real>(high);
  }
  measure_sizes(sample.triangles, name, scene);
  scene.grid = grid_of(values_of(sample.triangles));
  measure_pairs(sample, scene);
  return scene;
}

template SceneSample sample_of(const std::vector<Pair>&);
template DoubleSceneSample sample_of(const std::vector<DoublePair>&);
template strata::SceneFile measure_scene(const SceneSample&, const std::string&);
template strata::SceneFile measure_scene(const DoubleSceneSample&, const std::string&);

}  // namespace graze::analysis
