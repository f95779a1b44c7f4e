// SPDX-License-Identifier: Apache-2.0
#include "fuzz/hunt/feedback.h"

#include <algorithm>
#include <cmath>
#include <source_location>

#include "analysis/lane_trace.h"
#include "core/fnv1a.h"
#include "core/lanes/with_error_bound.h"
#include "cuda/twin/twin.h"

namespace graze::fuzz {
namespace {

enum class Kind : std::uint32_t { failure, closeness, site, parting, contraction };

std::uint64_t mixed(std::uint64_t hash, std::uint64_t value) {  // FNV-1a over whole words, with a final shift
  hash = (hash ^ value) * 0x100000001b3u;
  return hash ^ hash >> 29;
}

template <class... Values>
std::uint16_t feature(Kind kind, Values... values) {
  std::uint64_t hash = mixed(0xcbf29ce484222325u, static_cast<std::uint64_t>(kind));
  ((hash = mixed(hash, static_cast<std::uint64_t>(values))), ...);
  return static_cast<std::uint16_t>(hash ^ hash >> 16 ^ hash >> 32 ^ hash >> 48);
}

// Compares like the default policy, and also records the ratio of each value to its error bound.
template <class Real>
struct Meter {
  using Number = WithErrorBound<Real>;
  int algorithm;
  Features* features;
  int* asked;

  Number snap(Site site, const Number& x, std::source_location where = std::source_location::current()) const {
    return note(site, x.value, x.error, where), x;
  }
  bool less(Site site, const Number& l, const Number& r,
            std::source_location where = std::source_location::current()) const {
    return note(site, l.value - r.value, l.error + r.error, where), l < r;
  }
  bool at_most(Site site, const Number& l, const Number& r,
               std::source_location where = std::source_location::current()) const {
    return note(site, l.value - r.value, l.error + r.error, where), l <= r;
  }

 private:
  void note(Site site, Real value, Real error, const std::source_location& where) const {
    constexpr int kMost = 24, kNotFinite = 99;
    int octave = -kMost;  // for zero
    if (!std::isfinite(value) || !std::isfinite(error))
      octave = kNotFinite;
    else if (value != 0)
      octave = error == 0 ? kMost : std::clamp(std::ilogb(magnitude(value) / error), -8, kMost);
    const int place = std::min((*asked)++, 31);
    features->push_back(
        feature(Kind::site, algorithm, sizeof(Real), static_cast<int>(site), where.line(), place, octave + 128));
  }
};

template <std::size_t place, class Real>
void measure_sites(const BasicPair<Real>& pair, Features& features) {
  int asked = 0;
  const Meter<Real> meter{static_cast<int>(place), &features, &asked};
  const auto number = [](const Vec3<Real>& v) {
    using Number = WithErrorBound<Real>;
    return Vec3<Number>{Number(v.x), Number(v.y), Number(v.z)};
  };
  const Vec3<WithErrorBound<Real>> a[3] = {number(pair.a[0]), number(pair.a[1]), number(pair.a[2])},
                                   b[3] = {number(pair.b[0]), number(pair.b[1]), number(pair.b[2])};
  std::tuple_element_t<place, Algorithms>::decide(a, b, meter);
}

void measure_sites(int algorithm, const Pair& stored, const DoublePair& doubles, Features& features) {
  const auto one = [&]<std::size_t place>(std::integral_constant<std::size_t, place>) {
    if (algorithm != static_cast<int>(place)) return;
    measure_sites<place>(stored, features);
    measure_sites<place>(doubles, features);
  };
  [&]<std::size_t... places>(std::index_sequence<places...>) {
    (one(std::integral_constant<std::size_t, places>()), ...);
  }
  (std::make_index_sequence<kAlgorithmCount>());
}

// The first line at which the runs in float32 and float64 decide a comparison differently; 0 if there is none.
unsigned line_of_parting(int algorithm, const Pair& stored, const DoublePair& doubles) {
  const Trace<double> narrow = run_traced<float>(algorithm, stored), wide = run_traced<double>(algorithm, doubles);
  const std::size_t both = std::min(narrow.seen.size(), wide.seen.size());
  for (std::size_t i = 0; i < both; ++i) {
    if (narrow.seen[i].held != wide.seen[i].held) return narrow.seen[i].where.line();
  }
  return 0;
}

int number_of(const Hulls& hulls) { return (hulls.dimension_a * 3 + hulls.dimension_b) * 2 + hulls.coplanar; }

}  // namespace

Feedback::Feedback(const std::vector<const Lane*>& lanes) : lanes_(lanes) {
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    const Lane& lane = *lanes[l];
    if (lane.algorithm >= 0 && std::find(algorithms_.begin(), algorithms_.end(), lane.algorithm) == algorithms_.end())
      algorithms_.push_back(lane.algorithm);
    if (lane.foreign || lane.under || cuda::contraction_sites(lane).empty()) continue;
    const Lane* rounded = counterpart(lane, rounded_variant(lane.variant));
    const auto found = std::find(lanes.begin(), lanes.end(), rounded);
    if (found != lanes.end()) fused_.push_back({l, static_cast<std::size_t>(found - lanes.begin())});
  }
}

Features Feedback::features(const AnyPair& pair, const PairJudge::Found& found) const {
  const Pair stored = pair.in_float32();
  const Hulls hulls = visit(pair, [](const auto& own) { return oracle::hulls(own); });
  Features features;
  features.push_back(feature(Kind::closeness, found.bucket + kBucketMost, number_of(hulls)));
  for (const int algorithm : algorithms_) measure_sites(algorithm, stored, pair.doubles, features);
  for (const analysis::Signature& failure : found.failures) {
    features.push_back(feature(Kind::failure, fnv1a(analysis::coarse_key(failure))));
    const auto lane =
        std::find_if(lanes_.begin(), lanes_.end(), [&](const Lane* l) { return l->info->id == failure.subject; });
    if ((*lane)->algorithm >= 0)
      features.push_back(
          feature(Kind::parting, (*lane)->algorithm, line_of_parting((*lane)->algorithm, stored, pair.doubles)));
  }
  for (const Fused& fused : fused_) {
    if (found.verdicts[fused.lane] == found.verdicts[fused.rounded]) continue;
    const Lane& lane = *lanes_[fused.lane];
    const AnyPair seen = analysis::seen_by(lane, pair);
    const std::size_t sites = cuda::contraction_sites(lane).size();
    std::vector<std::uint64_t> all((sites + 63) / 64, ~std::uint64_t{0});
    for (std::size_t site = 0; site < sites; ++site) {
      all[site / 64] ^= std::uint64_t{1} << site % 64;
      if (cuda::decide_fusing(lane, seen, all) != found.verdicts[fused.lane])
        features.push_back(feature(Kind::contraction, fused.lane, site));
      all[site / 64] ^= std::uint64_t{1} << site % 64;
    }
  }
  std::sort(features.begin(), features.end());
  features.erase(std::unique(features.begin(), features.end()), features.end());
  return features;
}

}  // namespace graze::fuzz
