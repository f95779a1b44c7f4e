// SPDX-License-Identifier: Apache-2.0
#include "analysis/pareto.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>

#include "backends/backends.h"
#include "core/lanes/verdicts.h"
#include "subjects/subjects.h"

namespace graze::analysis {
namespace {

template <class Real>
BasicPair<Real> moved(const BasicPair<Real>& pair, Extreme extreme, int k) {
  BasicPair<Real> result = pair;
  Real size = 0;
  for (int c = 0; c < kCoordinates; ++c)
    size = std::max(size, std::fabs(coordinates(pair)[c] - coordinates(pair)[c % 3]));
  // A power of two, so only the addition below rounds.
  const Real offset = size > 0 && std::isfinite(size) ? std::ldexp(Real(1), std::ilogb(size) + k) : 0;
  for (int c = 0; c < kCoordinates; ++c) {
    Real& x = coordinates(result)[c];
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

// The processor time of this thread. It excludes time in which other programs run, but such programs still slow the
// thread, because they share its cache and its clock.
double processor_nanoseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
}

// The nanoseconds that reading the clock adds to a measured time; they matter if few pairs are timed.
double nanoseconds_of_the_clock() {
  static const double least = [] {
    double found = HUGE_VAL;
    for (int i = 0; i < 1000; ++i) {
      const double start = processor_nanoseconds();
      found = std::min(found, processor_nanoseconds() - start);
    }
    return found;
  }();
  return least;
}

template <class PairOf>
double nanoseconds_of(const DecideBlock& lane, const std::vector<PairOf>& pairs, Calls calls) {
  VerdictBits bits;
  std::uint64_t intersects = 0, declined = 0;
  const double start = processor_nanoseconds();
  if (calls == Calls::of_blocks) {
    decide(lane, std::span<const PairOf>(pairs), bits);
  } else {
    for (const PairOf& pair : pairs) lane(&pair, 1, &intersects, &declined);
  }
  // A pass never takes no time, but the clock may show less than it takes to read the clock.
  const double taken = std::max(1.0, processor_nanoseconds() - start - nanoseconds_of_the_clock());
  return taken / static_cast<double>(pairs.size());
}

}  // namespace

std::string_view name(Extreme extreme) {
  constexpr std::string_view kNames[] = {"scale", "offset", "flatness", "aspect"};
  return kNames[static_cast<int>(extreme)];
}

double nanoseconds_a_pair(const DecideBlock& lane, const strata::PairBlock& pairs, Calls calls) {
  return pairs.in_doubles() && lane.decides_doubles() ? nanoseconds_of(lane, pairs.doubles, calls)
                                                      : nanoseconds_of(lane, pairs.floats, calls);
}

Cost quartiles(std::vector<double> nanoseconds) {
  std::sort(nanoseconds.begin(), nanoseconds.end());
  const std::size_t quarter = nanoseconds.size() / 4;
  return {nanoseconds[quarter], nanoseconds[nanoseconds.size() / 2], nanoseconds[nanoseconds.size() - 1 - quarter]};
}

std::string why_not_timed(const Lane& lane) {
  if (backends::language_of(lane) == backends::Language::cuda)
    return lane.foreign ? "a CUDA source is not timed" : "only --device times CUDA lanes";
  if (!lane.toolchain.empty()) return "the time of a toolchain's program includes the pipes to it";
  const subjects::Opened* subject = lane.foreign ? subjects::opened(lane.lane_name().subject) : nullptr;
  return subject && subject->kind == "command" ? "the time of a program includes reading and writing lines" : "";
}

std::vector<std::optional<Cost>> costs_of(std::span<const Lane* const> lanes, const strata::PairBlock& pairs,
                                          int passes, Calls calls) {
  std::vector<std::vector<double>> taken(lanes.size());
  std::vector<bool> failed(lanes.size());  // a failing lane may take seconds per pair, so it is not run again
  for (int pass = 0; pass < passes; ++pass) {
    for (std::size_t l = 0; l < lanes.size(); ++l) {
      const Lane& lane = *lanes[l];
      if (failed[l] || !why_not_timed(lane).empty()) continue;
      const double nanoseconds = nanoseconds_a_pair(lane.decide, pairs, lane.foreign ? Calls::of_blocks : calls);
      if (!lane.foreign) {
        taken[l].push_back(nanoseconds);
      } else if (calls == Calls::of_blocks || !subjects::opened(lane.lane_name().subject)->description.of_blocks) {
        const auto own = subjects::processes_of(lane).nanoseconds();
        failed[l] = !own;
        if (own) taken[l].push_back(static_cast<double>(*own) / static_cast<double>(pairs.size()));
      }
    }
  }
  std::vector<std::optional<Cost>> costs;
  for (std::size_t l = 0; l < lanes.size(); ++l)
    costs.push_back(failed[l] || taken[l].empty() ? std::nullopt : std::optional(quartiles(std::move(taken[l]))));
  return costs;
}

strata::PairBlock first_pairs(std::span<const strata::PairSource> sources, std::size_t count) {
  const bool in_doubles = any_in_doubles(sources);
  strata::PairBlock pairs;
  for (std::uint64_t i = 0; pairs.size() < count; ++i) {
    const std::size_t before = pairs.size();
    for (const strata::PairSource& source : sources) {
      if (i >= source.pairs || pairs.size() == count) continue;
      const AnyPair pair = source.any_pair(i);
      pairs.floats.push_back(pair.in_float32());
      if (in_doubles) pairs.doubles.push_back(pair.doubles);
    }
    if (pairs.size() == before) break;
  }
  return pairs;
}

bool is_dominated(const Offer& offer, const std::vector<Offer>& offers, std::optional<Cost> Offer::*by) {
  return std::any_of(offers.begin(), offers.end(), [&](const Offer& other) {
    if (!(offer.*by && other.*by)) return false;
    const double own = offer.errors.share_not_true(), others = other.errors.share_not_true();
    const Cost &cost = *(offer.*by), &of_other = *(other.*by);
    return others < own ? of_other.middle <= cost.middle : others == own && of_other.high < cost.low;
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
  for (strata::PairSource& source : result)
    source = changed(std::move(source), [extreme, k](const auto& pair) { return moved(pair, extreme, k); });
  return result;
}

std::vector<ErrorsAt> ExtremeCurve::errors() const {
  std::vector<ErrorsAt> result;
  for (const auto& [exponent, found] : points) result.push_back({exponent, found.not_true(), found.pairs});
  return result;
}

}  // namespace graze::analysis
