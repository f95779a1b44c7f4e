// SPDX-License-Identifier: Apache-2.0
#include "analysis/tuning.h"

#include <algorithm>
#include <array>
#include <boost/math/distributions/binomial.hpp>

#include "analysis/lane_trace.h"
#include "analysis/scales.h"

namespace graze::analysis {
namespace {

constexpr double kOutward = 0x1p-40;  // exceeds the relative error of the library's quantiles
constexpr std::uint64_t kPairsForScale = 100'000;

const PolicyErrors& best_of(const Curve& curve, Forbid forbid, double max_rate) {
  return *std::min_element(curve.points.begin(), curve.points.end(), [&](const PolicyErrors& l, const PolicyErrors& r) {
    return rank(l, forbid, max_rate) < rank(r, forbid, max_rate);
  });
}

class Tuner {
 public:
  explicit Tuner(const TuneSpec& spec) : spec_(spec) {}

  Tuned run() {
    result_.zero = sweep_all(std::vector<std::string>{""}).front();
    const auto sweep = [&](Policies policies) { return sweep_all(policies); };
    const auto best = [&](const Curve& curve) {
      return &best_of(curve, spec_.forbid, spec_.max_rate) - curve.points.data();
    };
    if (spec_.by_value) {
      result_.curves = {{"", false, {}}};
      sweep_values(result_.curves, log2_cube(spec_.sources), sweep, best);
    } else {
      std::vector<std::string> sites = {""};
      sites.insert(sites.end(), spec_.sites.begin(), spec_.sites.end());
      for (const std::string& site : sites) {
        for (const bool relative : {true, false}) result_.curves.push_back({site, relative, {}});
      }
      sweep_curves(result_.curves, log2_cube(spec_.sources), sweep, best);
    }
    choose();
    find_dead();
    find_scale_break();
    find_interactions();
    return std::move(result_);
  }

 private:
  std::vector<PolicyErrors> sweep_all(Policies policies) const { return spec_.sweep(policies, spec_.sources); }

  PolicyRank rank(const PolicyErrors& errors) const { return analysis::rank(errors, spec_.forbid, spec_.max_rate); }

  void choose() {
    const PolicyErrors* best = &result_.zero;  // a tie keeps the policy of the earlier curve
    for (const Curve& curve : result_.curves) {
      for (const PolicyErrors& point : curve.points) {
        if (rank(point) < rank(*best)) best = &point;
      }
    }
    result_.chosen = best->policy;
    const std::vector<PolicyErrors> found = spec_.sweep(std::vector<std::string>{"", result_.chosen}, spec_.others);
    result_.zero_confirmed = found[0];
    result_.confirmed = found[1];
    result_.bound = upper_bound(forbidden(result_.confirmed, spec_.forbid), result_.confirmed.pairs);
    result_.other_bound = other_bound(result_.confirmed, spec_.forbid);
    result_.result = result_of(*best, result_.confirmed, spec_.forbid, spec_.max_rate, spec_.max_other);
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
    std::vector<strata::PairSource> some = spec_.others;
    for (strata::PairSource& source : some) source.pairs = std::min(source.pairs, kPairsForScale / some.size() + 1);
    const auto at = [&](int k) {
      return spec_.sweep(std::vector<std::string>{result_.chosen}, scaled(some, k)).front();
    };
    const PolicyErrors& here = result_.scale.here = at(0);
    const auto breaks = [&](const PolicyErrors& there) {
      return doubles(here.wrong(), there.wrong(), here.pairs) ||
             doubles(forbidden(here, spec_.forbid), forbidden(there, spec_.forbid), here.pairs);
    };
    const auto find = [&](int sign, int& exponent, PolicyErrors& errors) {
      int good = 0, bad = 0;
      for (int k = 1; k <= kMostScale && bad == 0; k *= 2) (breaks(at(sign * k)) ? bad : good) = k;
      if (bad == 0) return;
      while (bad - good > 1) {
        const int middle = (good + bad) / 2;
        (breaks(at(sign * middle)) ? bad : good) = middle;
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
        const std::vector<PolicyErrors> found =
            sweep_all(std::vector<std::string>{first, second, first + "," + second});
        result_.interactions.push_back({live[i], live[j], found[0], found[1], found[2]});
      }
    }
  }

  const TuneSpec& spec_;
  Tuned result_;
};

}  // namespace

std::vector<strata::PairSource> scaled(Sources sources, int k) {
  std::vector<strata::PairSource> result;
  for (const strata::PairSource& source : sources)
    result.push_back(changed(source, [k](const auto& pair) { return exactly_scaled(pair, k).value_or(pair); }));
  return result;
}

double upper_bound(std::uint64_t count, std::uint64_t of) {
  if (of == 0 || count >= of) return 1;
  const double nearest = boost::math::binomial_distribution<>::find_upper_bound_on_p(static_cast<double>(of),
                                                                                     static_cast<double>(count), 0.05);
  return std::min(1.0, nearest * (1 + kOutward));
}

double lower_bound(std::uint64_t count, std::uint64_t of) {
  if (count == 0) return 0;
  const double nearest = boost::math::binomial_distribution<>::find_lower_bound_on_p(static_cast<double>(of),
                                                                                     static_cast<double>(count), 0.05);
  return std::max(0.0, nearest * (1 - kOutward));
}

std::uint64_t forbidden(const PolicyErrors& errors, Forbid forbid) {
  return forbid == Forbid::false_negative   ? errors.false_negative
         : forbid == Forbid::false_positive ? errors.false_positive
                                            : errors.wrong();
}

PolicyRank rank(const PolicyErrors& errors, Forbid forbid, double max_rate) {
  const std::uint64_t bad = forbidden(errors, forbid), others = errors.wrong() - bad;
  const bool too_many = static_cast<double>(bad) > max_rate * static_cast<double>(errors.pairs);
  return too_many ? PolicyRank{true, bad, others} : PolicyRank{false, others, bad};
}

double other_bound(const PolicyErrors& errors, Forbid forbid) {
  return forbid == Forbid::any ? 0 : upper_bound(errors.wrong() - forbidden(errors, forbid), errors.pairs);
}

TuneResult result_of(const PolicyErrors& chosen_on, const PolicyErrors& confirmed, Forbid forbid, double max_rate,
                     double max_other) {
  const std::uint64_t bad = forbidden(confirmed, forbid);
  if (rank(chosen_on, forbid, max_rate).too_many && rank(confirmed, forbid, max_rate).too_many)
    return TuneResult::not_satisfiable;
  if (rank(confirmed, forbid, max_rate).too_many) return TuneResult::not_confirmed;
  if (lower_bound(confirmed.wrong() - bad, confirmed.pairs) > max_other) return TuneResult::not_useful;
  return upper_bound(bad, confirmed.pairs) <= max_rate && other_bound(confirmed, forbid) <= max_other
             ? TuneResult::satisfied
             : TuneResult::too_few_pairs;
}

std::vector<const PolicyErrors*> best_of_curves(const std::vector<Curve>& curves, Forbid forbid, double max_rate) {
  std::vector<const PolicyErrors*> best;
  for (const Curve& curve : curves) best.push_back(&best_of(curve, forbid, max_rate));
  return best;
}

Tuned tune(const TuneSpec& spec) { return Tuner(spec).run(); }

std::vector<std::string> sites_asked(const Lane& lane, Sources sources) {
  std::array<bool, kSiteCount> asked{};
  for (const strata::PairSource& source : sources) {
    for (std::uint64_t i = 0; i < std::min<std::uint64_t>(source.pairs, 500); ++i) {
      for (const Seen<double>& seen : run_led(lane, seen_by(lane, source.any_pair(i)), Contraction::none, {}).seen) {
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
