// SPDX-License-Identifier: Apache-2.0
#include "analysis/pareto.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "core/lanes/verdicts.h"

namespace graze::analysis {
namespace {

Pair moved(const Pair& pair, Extreme extreme, int k) {
  Pair result = pair;
  float size = 0;
  for (int c = 0; c < kCoordinates; ++c)
    size = std::max(size, std::fabs(coordinates(pair)[c] - coordinates(pair)[c % 3]));
  // A power of two, so only the addition below rounds.
  const float offset = size > 0 && std::isfinite(size) ? std::ldexp(1.0f, std::ilogb(size) + k) : 0;
  for (int c = 0; c < kCoordinates; ++c) {
    float& x = coordinates(result)[c];
    switch (extreme) {
      case Extreme::scale:
        x = std::ldexp(x, k);
        break;
      case Extreme::offset:
        x += offset;
        break;
      case Extreme::flatness:
        x = c % 3 == 2 ? std::ldexp(x, -k) : x;
        break;
      case Extreme::aspect:
        x = c % 3 != 2 ? std::ldexp(x, -k) : x;
        break;
    }
  }
  return is_finite(result) ? result : pair;
}

}  // namespace

std::string_view name(Extreme extreme) {
  constexpr std::string_view kNames[] = {"scale", "offset", "flatness", "aspect"};
  return kNames[static_cast<int>(extreme)];
}

double nanoseconds_a_pair(const DecideBlock& lane, const std::vector<Pair>& pairs, Calls calls) {
  VerdictBits bits;
  std::uint64_t intersects = 0, declined = 0;
  const auto start = std::chrono::steady_clock::now();
  if (calls == Calls::of_blocks) {
    decide(lane, pairs, bits);
  } else {
    for (const Pair& pair : pairs) lane(&pair, 1, &intersects, &declined);
  }
  const std::chrono::duration<double, std::nano> taken = std::chrono::steady_clock::now() - start;
  return taken.count() / static_cast<double>(pairs.size());
}

Cost quartiles(std::vector<double> nanoseconds) {
  std::sort(nanoseconds.begin(), nanoseconds.end());
  const std::size_t quarter = nanoseconds.size() / 4;
  return {nanoseconds[quarter], nanoseconds[nanoseconds.size() / 2], nanoseconds[nanoseconds.size() - 1 - quarter]};
}

std::vector<Cost> costs_of(std::span<const DecideBlock> lanes, const std::vector<Pair>& pairs, int passes,
                           Calls calls) {
  std::vector<std::vector<double>> taken(lanes.size());
  for (int pass = 0; pass < passes; ++pass) {
    for (std::size_t l = 0; l < lanes.size(); ++l) taken[l].push_back(nanoseconds_a_pair(lanes[l], pairs, calls));
  }
  std::vector<Cost> costs;
  for (std::vector<double>& of : taken) costs.push_back(quartiles(std::move(of)));
  return costs;
}

std::vector<Pair> first_pairs(std::span<const strata::PairSource> sources, std::size_t count) {
  std::vector<Pair> pairs;
  for (std::uint64_t i = 0; pairs.size() < count; ++i) {
    const std::size_t before = pairs.size();
    for (const strata::PairSource& source : sources) {
      if (i < source.pairs && pairs.size() < count) pairs.push_back(source.pair(i));
    }
    if (pairs.size() == before) break;
  }
  return pairs;
}

bool is_dominated(const Offer& offer, const std::vector<Offer>& offers, Cost Offer::*by) {
  return std::any_of(offers.begin(), offers.end(), [&](const Offer& other) {
    const double less = other.errors.share_not_right() - offer.errors.share_not_right(),
                 faster = (other.*by).middle - (offer.*by).middle;
    return less <= 0 && faster <= 0 && (less < 0 || faster < 0);
  });
}

void mark_dominated(std::vector<Offer>& offers) {
  for (Offer& offer : offers) offer.dominated = is_dominated(offer, offers, &Offer::near);
}

std::vector<int> exponents(Extreme extreme) {
  std::vector<int> result;
  const int low = extreme == Extreme::scale ? -144 : 0, high = extreme == Extreme::scale ? 120 : 24;
  const int step = extreme == Extreme::scale ? 8 : 2;
  for (int k = low; k <= high; k += step) result.push_back(k);
  return result;
}

std::vector<strata::PairSource> made_extreme(std::span<const strata::PairSource> sources, Extreme extreme, int k) {
  std::vector<strata::PairSource> result(sources.begin(), sources.end());
  if (k == 0 && extreme != Extreme::offset) return result;
  for (strata::PairSource& source : result) {
    source.stratum = -1;
    source.pair = [draw = source.pair, extreme, k](std::uint64_t index) { return moved(draw(index), extreme, k); };
  }
  return result;
}

std::optional<int> ExtremeCurve::right_to(int direction) const {
  const auto ordinary = std::find_if(points.begin(), points.end(), [](const auto& point) { return point.first == 0; });
  if (ordinary == points.end()) return std::nullopt;
  const double most = std::max(2 * ordinary->second.share_not_right(), 1e-3);
  int last = 0;
  const auto at = [&](std::ptrdiff_t i) -> const std::pair<int, PolicyErrors>& {
    return points[static_cast<std::size_t>(i)];
  };
  for (std::ptrdiff_t i = ordinary - points.begin(); i >= 0 && i < std::ssize(points); i += direction) {
    if (at(i).second.share_not_right() > most) return last;
    last = at(i).first;
  }
  return std::nullopt;
}

}  // namespace graze::analysis
