// SPDX-License-Identifier: Apache-2.0
#include "analysis/tuning.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <tuple>

#include "analysis/lane_trace.h"
#include "core/exact/exact.h"
#include "cuda/twin/twin.h"

namespace graze::analysis {
namespace {

constexpr std::size_t kBlock = 1024;  // pairs that are drawn and judged, then decided under all policies
constexpr std::size_t kWords = kBlock / 64;
constexpr std::uint64_t kPairsForScale = 100'000;

struct Verdicts {
  std::array<std::uint64_t, kWords> intersects{}, declined{};

  Verdicts(const DecideBlock& decide, const std::vector<Pair>& pairs) {
    decide(pairs.data(), pairs.size(), intersects.data(), declined.data());
  }
};

struct Block {
  int source;
  std::uint64_t first, count;
};

std::vector<Block> blocks_of(std::span<const strata::PairSource> sources) {
  std::vector<Block> blocks;
  for (std::size_t s = 0; s < sources.size(); ++s) {
    for (std::uint64_t first = 0; first < sources[s].pairs; first += kBlock)
      blocks.push_back({static_cast<int>(s), first, std::min<std::uint64_t>(kBlock, sources[s].pairs - first)});
  }
  return blocks;
}

void keep_first(std::optional<PairPlace>& kept, const std::optional<PairPlace>& found) {
  if (found && (!kept || *found < *kept)) kept = found;
}

// Counts the bits, and keeps the first one's place.
void add(std::uint64_t bits, const PairPlace& word, std::uint64_t& count, std::optional<PairPlace>& first) {
  if (bits == 0) return;
  count += static_cast<std::uint64_t>(std::popcount(bits));
  keep_first(first, PairPlace{word.source, word.index + static_cast<std::uint64_t>(std::countr_zero(bits))});
}

std::string tolerance(const std::string& site, bool relative, double value) {
  return fmt::format("{}{}{}:{:.3g}", site, site.empty() ? "" : "=", relative ? "rel" : "abs", value);
}

// log2 of the sources' typical size: the median of the largest differences of coordinates within a pair.
int log2_size(std::span<const strata::PairSource> sources) {
  std::vector<float> sizes;
  for (const strata::PairSource& source : sources) {
    for (std::uint64_t i = 0; i < std::min<std::uint64_t>(source.pairs, 200); ++i) {
      const Pair pair = source.pair(i);
      float size = 0;
      for (int c = 0; c < 3; ++c) {
        float low = coordinates(pair)[c], high = low;
        for (int k = c; k < kCoordinates; k += 3) {
          low = std::min(low, coordinates(pair)[k]);
          high = std::max(high, coordinates(pair)[k]);
        }
        size = std::max(size, high - low);
      }
      sizes.push_back(size);
    }
  }
  std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2), sizes.end());
  const float median = sizes[sizes.size() / 2];
  return median > 0 && std::isfinite(median) ? std::ilogb(median) : 0;
}

class Tuner {
 public:
  explicit Tuner(const TuneSpec& spec) : spec_(spec), low_(-60), high_(20), cube_(3 * log2_size(spec.sources)) {}

  Tuned run() {
    result_.zero = sweep_one("");
    std::vector<std::string> sites = {""};
    sites.insert(sites.end(), spec_.sites.begin(), spec_.sites.end());
    for (const std::string& site : sites) {
      for (const bool relative : {true, false}) result_.curves.push_back({site, relative, {}});
    }
    add_points([&](const Curve&) { return steps(low_, high_, 1); });
    // Quarter octaves around what is best so far.
    add_points([&](const Curve& curve) {
      const auto best =
          std::min_element(curve.points.begin(), curve.points.end(),
                           [&](const PolicyErrors& l, const PolicyErrors& r) { return rank(l) < rank(r); });
      const double at = low_ + static_cast<double>(best - curve.points.begin());
      return steps(at - 1, at + 1, 0.25);
    });
    choose();
    find_dead();
    find_scale_break();
    find_interactions();
    return std::move(result_);
  }

 private:
  std::vector<PolicyErrors> sweep_all(const std::vector<std::string>& policies) const {
    return sweep(spec_.decide, policies, spec_.sources, spec_.threads);
  }
  PolicyErrors sweep_one(const std::string& policy) const { return sweep_all({policy}).front(); }

  static std::vector<double> steps(double low, double high, double step) {
    std::vector<double> result;
    for (double at = low; at <= high; at += step) result.push_back(at);
    return result;
  }

  // Adds to each curve the points at these powers of two, all in one sweep.
  template <class StepsOf>
  void add_points(const StepsOf& steps_of) {
    std::vector<std::string> policies;
    std::vector<std::size_t> ends;
    for (const Curve& curve : result_.curves) {
      for (const double at : steps_of(curve))
        policies.push_back(tolerance(curve.site, curve.relative, std::exp2(at + (curve.relative ? 0 : cube_))));
      ends.push_back(policies.size());
    }
    const std::vector<PolicyErrors> errors = sweep_all(policies);
    std::size_t begin = 0;
    for (std::size_t c = 0; c < ends.size(); begin = ends[c++]) {
      std::vector<PolicyErrors>& points = result_.curves[c].points;
      for (std::size_t p = begin; p < ends[c]; ++p) {
        const bool known = std::any_of(points.begin(), points.end(),
                                       [&](const PolicyErrors& point) { return point.policy == errors[p].policy; });
        if (!known) points.push_back(errors[p]);
      }
      std::stable_sort(points.begin(), points.end(), [](const PolicyErrors& l, const PolicyErrors& r) {
        return tolerance_of(l.policy) < tolerance_of(r.policy);
      });
    }
  }

  // Low enough first, then by the other errors, then by those forbidden.
  std::tuple<bool, std::uint64_t, std::uint64_t> rank(const PolicyErrors& errors) const {
    const std::uint64_t bad = forbidden(errors, spec_.forbid);
    const bool too_many = static_cast<double>(bad) > spec_.max_rate * static_cast<double>(errors.pairs);
    return {too_many, too_many ? bad : errors.wrong() - bad, too_many ? errors.wrong() - bad : bad};
  }

  void choose() {
    const PolicyErrors* best = &result_.zero;  // curves stand in the order in which equals are preferred
    for (const Curve& curve : result_.curves) {
      for (const PolicyErrors& point : curve.points) {
        if (rank(point) < rank(*best)) best = &point;
      }
    }
    result_.chosen = best->policy;
    const std::vector<PolicyErrors> found =
        sweep(spec_.decide, std::vector<std::string>{"", result_.chosen}, spec_.others, spec_.threads);
    result_.zero_confirmed = found[0];
    result_.confirmed = found[1];
    const std::uint64_t bad = forbidden(result_.confirmed, spec_.forbid), of = result_.confirmed.pairs;
    result_.bound = upper_bound(bad, of);
    result_.result = result_.bound <= spec_.max_rate ? TuneResult::satisfied
                     : static_cast<double>(bad) <= spec_.max_rate * static_cast<double>(of)
                         ? TuneResult::too_few_pairs
                         : TuneResult::not_satisfiable;
  }

  void find_dead() {
    for (const std::string& site : spec_.sites) {
      const bool dead = std::all_of(result_.curves.begin(), result_.curves.end(), [&](const Curve& curve) {
        return curve.site != site || std::all_of(curve.points.begin(), curve.points.end(),
                                                 [](const PolicyErrors& point) { return point.changes_nothing(); });
      });
      if (dead) result_.dead.push_back(site);
    }
  }

  void find_scale_break() {
    if (result_.chosen.empty()) return;
    std::vector<strata::PairSource> some = spec_.sources;
    for (strata::PairSource& source : some) source.pairs = std::min(source.pairs, kPairsForScale / some.size() + 1);
    const auto at = [&](int k) {
      return sweep(spec_.decide, std::vector<std::string>{result_.chosen}, scaled(some, k), spec_.threads).front();
    };
    const std::uint64_t most = 2 * std::max<std::uint64_t>(at(0).wrong(), 5);
    const auto find = [&](int sign, int& exponent, PolicyErrors& errors) {
      int good = 0, bad = 0;
      for (int k = 1; k <= kMostScale && bad == 0; k *= 2) (at(sign * k).wrong() > most ? bad : good) = k;
      if (bad == 0) return;
      while (bad - good > 1) {
        const int middle = (good + bad) / 2;
        (at(sign * middle).wrong() > most ? bad : good) = middle;
      }
      exponent = sign * bad;
      errors = at(exponent);
    };
    find(1, result_.scale.up, result_.scale.at_up);
    find(-1, result_.scale.down, result_.scale.at_down);
  }

  void find_interactions() {
    if (result_.chosen.empty() || result_.chosen.find('=') != std::string::npos) return;
    std::vector<std::string> live;
    for (const std::string& site : spec_.sites) {
      if (std::find(result_.dead.begin(), result_.dead.end(), site) == result_.dead.end()) live.push_back(site);
    }
    for (std::size_t i = 0; i < live.size(); ++i) {
      for (std::size_t j = i + 1; j < live.size(); ++j) {
        const std::string first = live[i] + "=" + result_.chosen, second = live[j] + "=" + result_.chosen;
        const std::vector<PolicyErrors> found = sweep_all({first, second, first + "," + second});
        result_.interactions.push_back({live[i], live[j], found[0], found[1], found[2]});
      }
    }
  }

  const TuneSpec& spec_;
  double low_, high_;  // of the range, as powers of two
  double cube_;        // of a typical length cubed
  Tuned result_;
};

}  // namespace

PolicyErrors& PolicyErrors::operator+=(const PolicyErrors& other) {
  pairs += other.pairs;
  misses += other.misses;
  false_hits += other.false_hits;
  declined += other.declined;
  mended += other.mended;
  broken += other.broken;
  keep_first(first_mended, other.first_mended);
  keep_first(first_broken, other.first_broken);
  return *this;
}

double tolerance_of(const std::string& policy) { return std::stod(policy.substr(policy.rfind(':') + 1)); }

DecideUnder policies_of(const Lane& lane) {
  return [&lane](const std::string& policy) {
    return policy.empty() ? cuda::block_on_host(lane) : cuda::block_on_host(lane_under(lane, policy));
  };
}

std::vector<PolicyErrors> sweep(const DecideUnder& decide, std::span<const std::string> policies,
                                std::span<const strata::PairSource> sources, int threads) {
  const DecideBlock zero = decide(""), exact = find_lane("exact/f32/cpu")->decide;
  std::vector<DecideBlock> under;
  std::vector<PolicyErrors> empty;
  for (const std::string& policy : policies) {
    under.push_back(decide(policy));
    empty.emplace_back().policy = policy;
  }
  const std::vector<Block> blocks = blocks_of(sources);
  const auto count = static_cast<std::size_t>(threads > 0 ? threads : tbb::info::default_concurrency());
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, count);
  tbb::enumerable_thread_specific<std::vector<PolicyErrors>> results(empty);
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
    const Block& block = blocks[b];
    std::vector<Pair> pairs;
    for (std::uint64_t i = 0; i < block.count; ++i)
      pairs.push_back(sources[static_cast<std::size_t>(block.source)].pair(block.first + i));
    const Verdicts truth(exact, pairs), without(zero, pairs);
    std::vector<PolicyErrors>& result = results.local();
    for (std::size_t p = 0; p < under.size(); ++p) {
      PolicyErrors& errors = result[p];
      const Verdicts with(under[p], pairs);
      for (std::size_t w = 0; w * 64 < pairs.size(); ++w) {
        const std::uint64_t judged = ~truth.declined[w];  // not finite: nothing is counted
        const std::uint64_t none = with.declined[w] & judged, was_none = without.declined[w] & judged;
        const std::uint64_t off = (with.intersects[w] ^ truth.intersects[w]) & judged & ~none;
        const std::uint64_t was_off = (without.intersects[w] ^ truth.intersects[w]) & judged & ~was_none;
        errors.misses += static_cast<std::uint64_t>(std::popcount(off & truth.intersects[w]));
        errors.false_hits += static_cast<std::uint64_t>(std::popcount(off & ~truth.intersects[w]));
        errors.declined += static_cast<std::uint64_t>(std::popcount(none));
        const PairPlace word{block.source, block.first + w * 64};
        add((was_off | was_none) & ~(off | none), word, errors.mended, errors.first_mended);
        add(~(was_off | was_none) & (off | none), word, errors.broken, errors.first_broken);
      }
      errors.pairs += pairs.size();
    }
  });
  for (const std::vector<PolicyErrors>& some : results) {
    for (std::size_t p = 0; p < some.size(); ++p) empty[p] += some[p];
  }
  return empty;
}

std::vector<strata::PairSource> scaled(std::span<const strata::PairSource> sources, int k) {
  std::vector<strata::PairSource> result(sources.begin(), sources.end());
  for (strata::PairSource& source : result) {
    source.pair = [draw = source.pair, k](std::uint64_t index) {
      const Pair pair = draw(index);
      Pair moved = pair;
      for (int c = 0; c < kCoordinates; ++c) {
        coordinates(moved)[c] = std::ldexp(coordinates(pair)[c], k);
        if (std::ldexp(coordinates(moved)[c], -k) != coordinates(pair)[c]) return pair;
      }
      return moved;
    };
  }
  return result;
}

double upper_bound(std::uint64_t count, std::uint64_t of) {
  if (of == 0 || count >= of) return 1;
  return boost::math::binomial_distribution<>::find_upper_bound_on_p(static_cast<double>(of),
                                                                     static_cast<double>(count), 0.05);
}

std::uint64_t forbidden(const PolicyErrors& errors, Forbid forbid) {
  return forbid == Forbid::miss ? errors.misses : forbid == Forbid::false_hit ? errors.false_hits : errors.wrong();
}

Tuned tune(const TuneSpec& spec) { return Tuner(spec).run(); }

std::vector<std::string> sites_asked(const Lane& lane, std::span<const strata::PairSource> sources) {
  std::array<bool, kSiteCount> asked{};
  for (const strata::PairSource& source : sources) {
    for (std::uint64_t i = 0; i < std::min<std::uint64_t>(source.pairs, 500); ++i) {
      for (const Seen<double>& seen : run_led(lane, source.pair(i), Contraction::none, {}).seen) {
        if (seen.site) asked[static_cast<std::size_t>(*seen.site)] = true;
      }
    }
  }
  std::vector<std::string> names;
  for (int s = 0; s < kSiteCount; ++s) {
    if (asked[static_cast<std::size_t>(s)]) names.emplace_back(name(static_cast<Site>(s)));
  }
  return names;
}

}  // namespace graze::analysis
