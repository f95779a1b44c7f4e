// SPDX-License-Identifier: Apache-2.0
#include "analysis/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "analysis/audit.h"
#include "analysis/convention.h"
#include "analysis/experiments.h"
#include "core/lanes/verdicts.h"
#include "core/relation_of.h"

namespace graze::analysis {
namespace {

constexpr std::string_view kComparisons[] = {"<", "<=", "==", ">", ">="};

// "core/vec3.h:46", independent of the folder in which the compiler found the file.
std::string line_of(const std::source_location& where) {
  const std::string_view file = where.file_name();
  const std::size_t folder = file.rfind("core/");
  return fmt::format("{}:{}", folder == std::string_view::npos ? file : file.substr(folder), where.line());
}

// As bits are added, a verdict may alternate between right and wrong until products are exact, or for ever if roots or
// quotients leave a tie open in every precision. Unless exact arithmetic was certain with kMostBits, a number of bits
// counts as enough only if it is at most half of kMostBits.
int bits_needed(int algorithm, const oracle::Exactly& exactly, const AnyPair& pair, Verdict truth) {
  const int least = pair.floats ? 24 : 53;
  const int bits = exactly.verdict == truth ? oracle::bits_needed(algorithm, pair.doubles, truth, least) : 0;
  const bool certain = exactly.certain && exactly.bits <= oracle::kMostBits;
  return !certain && bits > oracle::kMostBits / 2 ? 0 : bits;
}

// The pair's neighbours. A nudged pair may have a different truth, so its truth is computed.
template <class Real>
struct Neighbours {
  using Pairs = std::vector<BasicPair<Real>>;
  Pairs orders, mirrored, scalings;
  std::array<Pairs, kCoordinates> nudged;
  std::array<bool, kCoordinates> truth_stays;

  Neighbours(const BasicPair<Real>& pair, Verdict truth)
      : orders(analysis::orders(pair)), mirrored(analysis::mirrored(pair)), scalings(analysis::scalings(pair)) {
    for (std::size_t c = 0; c < kCoordinates; ++c) {
      nudged[c] = analysis::nudged(pair, static_cast<int>(c));
      truth_stays[c] = std::all_of(nudged[c].begin(), nudged[c].end(),
                                   [truth](const auto& one) { return oracle::cgal_verdict(one) == truth; });
    }
  }
};

template <class Real>
WrongOf wrong_of(const Lane& lane, const std::vector<BasicPair<Real>>& pairs, Verdict truth) {
  const std::vector<Verdict> said = verdicts_of(block_of(lane), pairs);
  const auto wrong = std::count_if(said.begin(), said.end(), [truth](Verdict v) { return is_wrong(v, truth); });
  return {static_cast<int>(wrong), static_cast<int>(pairs.size())};
}

// The same source on the same kind of processor, with every operation rounded as written.
const Lane& rounded_counterpart(const Lane& lane) { return *counterpart(lane, rounded_variant(lane.variant)); }

Cause first_cause(const Lane& lane, const AnyPair& pair, Verdict truth, const oracle::Exactly& exactly) {
  if (exactly.verdict != truth) return Cause::logic;
  if (decide_lane(rounded_counterpart(lane), pair) == truth)
    return info_of(lane.variant).arithmetic == Arithmetic::fast ? Cause::fast_math : Cause::contraction;
  const auto limited = [&](bool upper, bool lower) {
    return oracle::decide_limited(lane.algorithm, lane.scalar, pair.doubles, {upper, lower});
  };
  if (limited(false, false).verdict != truth) return Cause::rounding;
  const bool overflow = limited(true, false).verdict != truth, underflow = limited(false, true).verdict != truth;
  if (overflow != underflow) return overflow ? Cause::overflow : Cause::underflow;
  return limited(true, true).first == oracle::RangeEvent::overflow ? Cause::overflow : Cause::underflow;
}

// Some pairs need both more bits and wider exponents. The comparison that went wrong shows which limit was hit first.
// If a value is no longer a number, or is lost because it is below the least normal number, rounding is not the cause.
Cause refined(const LaneExplanation& lane, const AnyPair& pair) {
  const Step* told = lane.told();
  if (lane.cause != Cause::rounding || !told) return lane.cause;
  const oracle::RangeEvent first =
      oracle::decide_limited(lane.lane->algorithm, lane.lane->scalar, pair.doubles, {true, true}).first;
  const double least =
      lane.lane->scalar == Scalar::f32 ? double{std::numeric_limits<float>::min()} : std::numeric_limits<double>::min();
  const oracle::Beside& difference = told->difference;
  const bool lost = difference.lane == 0 && difference.decimal != "0" && std::abs(difference.exact) < least;
  if (first == oracle::RangeEvent::none || (std::isfinite(difference.lane) && !lost)) return Cause::rounding;
  return first == oracle::RangeEvent::overflow && !lost ? Cause::overflow : Cause::underflow;
}

Step step_of(const Seen<double>& seen, const oracle::ExactStep& exact) {
  return {line_of(seen.where),
          seen.site ? name(*seen.site) : "",
          seen.compared ? kComparisons[static_cast<int>(seen.comparison)] : "",
          exact.left,
          exact.right,
          exact.difference,
          seen.held,
          exact.held};
}

// Returns a function that runs the algorithm along a path with the cause removed. Empty for rounding, because exact
// arithmetic is the run without it.
WithoutCause without(Cause cause, const Lane& lane, const AnyPair& pair, Contraction rule) {
  if (cause == Cause::contraction)
    return [&lane, &pair](const Path& path) { return run_led(lane, pair, Contraction::none, path); };
  if (cause == Cause::overflow || cause == Cause::underflow) {
    return [&lane, &pair, rule](const Path& path) {
      return oracle::run_limited(lane.algorithm, lane.scalar, pair.doubles, {false, false}, rule, path);
    };
  }
  return {};
}

void add_steps(LaneExplanation& result, const AnyPair& pair, Verdict truth) {
  const Lane& lane = *result.lane;
  const Replay run = replay(lane, pair);
  result.evidence = run.evidence;
  result.rule = run.rule;
  if (run.evidence == Evidence::none) return;
  const std::vector<oracle::ExactStep> exact = oracle::exact_steps(lane.algorithm, lane.scalar, pair.doubles, run.run);
  if (result.cause != Cause::logic)
    result.deciding = deciding_comparisons(lane, pair, truth, run, without(result.cause, lane, pair, run.rule));
  const std::vector<Decider>& deciding = result.deciding;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const Seen<double>& seen = run.run.seen[i];
    if (!deciding.empty() && deciding.front().place == i) result.decisive = static_cast<int>(result.steps.size());
    if (seen.site || (seen.compared && seen.held != exact[i].held)) result.steps.push_back(step_of(seen, exact[i]));
  }
  for (std::size_t i = 1; i < deciding.size(); ++i) result.then.push_back(step_of(deciding[i].seen, deciding[i].exact));
}

LaneExplanation account_of(const Lane& lane, Verdict verdict, const AnyPair& pair, Verdict truth,
                           const oracle::Exactly& exactly) {
  LaneExplanation result{};
  result.lane = &lane;
  result.verdict = verdict;
  result.cause = first_cause(lane, pair, truth, exactly);
  result.exactly = exactly;
  add_steps(result, pair, truth);
  if (const Cause cause = refined(result, pair); cause != result.cause) {
    result.cause = cause;
    for (Decider& decider : result.deciding)
      decider.by_cause = is_by_cause(decider, without(cause, lane, pair, result.rule));
  }
  if (!cuda::contraction_sites(lane).empty()) result.contractions = blame(lane, pair);
  result.settled = audit(result, pair, truth);
  return result;
}

// The account of a lane whose steps are not known.
LaneExplanation without_steps(const Lane& lane, Verdict verdict, Cause cause, bool settled) {
  LaneExplanation result{};
  result.lane = &lane;
  result.verdict = verdict;
  result.cause = cause;
  result.exactly.verdict = Verdict::declined;
  result.evidence = Evidence::none;
  result.settled = settled ? Settled::yes : Settled::unknown;
  return result;
}

LaneExplanation account_of_foreign(const Lane& lane, Verdict verdict, const AnyPair& pair, Verdict truth) {
  Experiment found = known_experiment(lane, verdict, pair, truth);
  LaneExplanation result = without_steps(lane, verdict, found.cause, found.settled);
  result.experiment = std::move(found.evidence);
  result.line = std::move(found.line);
  if (result.cause == Cause::contraction && !cuda::contraction_sites(lane).empty()) {
    result.contractions = blame_apart(lane, pair, cuda::most_seconds(lane));
    if (!result.contractions.why_not.empty())
      result.experiment += "; which products matter is not known: " + result.contractions.why_not;
    const Lane* cpu = counterpart(lane, Variant::cpu);
    result.cpu_is_right = cpu && cpu->decide && decide_lane(*cpu, pair) == truth;
  }
  result.slow = found.slow || is_failure(verdict);
  return result;
}

const Lane& without_policy(const Lane& lane) {
  LaneName zero = lane.lane_name();
  zero.policy.clear();
  return *find_lane(id_of(zero));
}

LaneExplanation account_of_policy(const Lane& lane, Verdict verdict, const AnyPair& pair, Verdict truth) {
  const Lane& zero = without_policy(lane);
  LaneExplanation result = without_steps(lane, verdict, Cause::policy, true);
  if (verdict == Verdict::declined) {
    result.experiment = "its error bounds leave a comparison open, so it may decline";
  } else if (decide_lane(zero, pair) == truth) {
    result.experiment = fmt::format("without {} it is right", lane.policy);
  } else {
    result.cause = cause_of(zero, pair, truth);
    result.settled = Settled::unknown;
    result.experiment = fmt::format("without {} it is wrong too, for this reason", lane.policy);
  }
  return result;
}

// Requires: finite coordinates; the verdict is not the truth.
bool is_by_convention(const Lane& lane, Verdict verdict, const AnyPair& pair) {
  return lane.outside != 0 &&
         visit(pair, [&](const auto& own) { return by_convention(lane, verdict, own, relation_of(own)); });
}

// Names the number that is beyond float32's range, or the number that would make the verdict right if it were kept as a
// double.
std::string what_rounding_decides(const DoublePair& pair, const Pair& stored, Verdict truth) {
  const float* c = coordinates(stored);
  if (const auto beyond = std::find_if(c, c + kCoordinates, [](float x) { return std::isinf(x); });
      beyond != c + kCoordinates)
    return fmt::format("number {}, {}, is beyond float32's range", beyond - c + 1, coordinates(pair)[beyond - c]);
  int rounded = 0;
  for (int i = 0; i < kCoordinates; ++i) {
    if (double{c[i]} == coordinates(pair)[i]) continue;
    ++rounded;
    DoublePair kept = in_doubles(stored);
    coordinates(kept)[i] = coordinates(pair)[i];
    if (relation_of(kept).verdict == truth)
      return fmt::format("if only number {} were kept as {}, the verdict would be {}", i + 1, coordinates(pair)[i],
                         name(truth));
  }
  return fmt::format("it rounds {} numbers, and no single one, kept as it is, would make the verdict {}", rounded,
                     name(truth));
}

// Explains a float32 lane whose verdict is right for the pair as float32 stores it, or whose pair float32 cannot store.
LaneExplanation account_of_stored(const Lane& lane, Verdict verdict, const DoublePair& pair, const Pair& stored,
                                  Verdict truth) {
  LaneExplanation result = without_steps(lane, verdict, Cause::stored, true);
  result.experiment = what_rounding_decides(pair, stored, truth);
  result.beyond = !is_finite(stored);
  result.slow = true;  // the lane did not get this pair, so the pair's neighbours would show nothing
  return result;
}

// The pair as a lane decides it, and that pair's truth, which may differ from the given pair's if float32 changes the
// pair.
struct Own {
  AnyPair pair;
  Verdict truth;

  // Whether storing explains the verdict: this pair's truth differs from the given pair's, and the lane is right on
  // this pair, or float32 cannot hold the given pair.
  bool explains(Verdict verdict, Verdict truth_of_given) const {
    const bool ended = verdict == Verdict::crashed || verdict == Verdict::timed_out;
    return truth != truth_of_given && (verdict == truth || (truth == Verdict::declined && !ended));
  }
};

Own own_of(const Lane& lane, const AnyPair& pair, Verdict truth) {
  Own own{seen_by(lane, pair), truth};
  if (own.pair.floats && !pair.floats) own.truth = relation_or_declined(*own.pair.floats).verdict;
  return own;
}

// Whether two lanes perform the same computation: they share their source, and every operation is rounded as written.
bool same_run(const Lane& l, const Lane& r) {
  const auto rounded = [](const Lane& lane) { return info_of(lane.variant).arithmetic == Arithmetic::rounded; };
  return !l.foreign && l.policy == r.policy && l.info == r.info && l.scalar == r.scalar && rounded(l) && rounded(r);
}

template <class Real>
void add_surroundings(LaneExplanation& result, Verdict truth, const Neighbours<Real>& neighbours) {
  const Lane& lane = *result.lane;
  result.orders = wrong_of(lane, neighbours.orders, truth);
  result.mirrored = wrong_of(lane, neighbours.mirrored, truth);
  result.scalings = wrong_of(lane, neighbours.scalings, truth);
  for (std::size_t c = 0; c < kCoordinates; ++c) {
    result.matters[c] = !neighbours.truth_stays[c];
    if (result.matters[c]) continue;
    const std::vector<Verdict> said = verdicts_of(block_of(lane), neighbours.nudged[c]);
    result.matters[c] = std::find(said.begin(), said.end(), truth) != said.end();
  }
}

}  // namespace

Cause cause_of(const Lane& lane, const AnyPair& given, Verdict truth_of_given) {
  const Own own = own_of(lane, given, truth_of_given);
  const auto& [pair, truth] = own;
  const Verdict verdict = decide_lane(lane, pair);
  if (own.explains(verdict, truth_of_given)) return Cause::stored;
  if (lane.foreign) return account_of_foreign(lane, verdict, pair, truth).cause;
  if (lane.under) return account_of_policy(lane, verdict, pair, truth).cause;
  LaneExplanation result{};
  result.lane = &lane;
  result.exactly = oracle::decide_exactly(lane.algorithm, pair.doubles);
  result.cause = first_cause(lane, pair, truth, result.exactly);
  // If rounding seems to be the cause, only the steps show whether the exponent range contributed.
  if (result.cause != Cause::rounding || !leaves_exponents(lane, pair)) return result.cause;
  add_steps(result, pair, truth);
  return refined(result, pair);
}

bool leaves_exponents(const Lane& lane, const AnyPair& pair) {
  if (lane.foreign || lane.under || lane.exact) return false;  // the answer is not known, or exponents have no effect
  const DecideBlock block = block_of(rounded_counterpart(lane));
  std::uint64_t intersects, declined;
  std::feclearexcept(FE_OVERFLOW | FE_UNDERFLOW);
  visit(seen_by(lane, pair), [&](const auto& own) { block(&own, 1, &intersects, &declined); });
  return std::fetestexcept(FE_OVERFLOW | FE_UNDERFLOW) != 0;
}

std::string_view name(Settled settled) {
  constexpr std::string_view kNames[] = {"yes", "not without it", "not alone", "not by few comparisons", "unknown"};
  return kNames[static_cast<int>(settled)];
}

std::string_view name(Cause cause) {
  constexpr std::string_view kNames[] = {"rounding",
                                         "contraction",
                                         "fast math",
                                         "overflow",
                                         "underflow",
                                         "logic",
                                         "absolute epsilon",
                                         "order-dependent",
                                         "degenerate input",
                                         "crash",
                                         "no answer in time",
                                         "unstable",
                                         "policy",
                                         "relative epsilon",
                                         "uninitialised",
                                         "excess precision",
                                         "stored"};
  return kNames[static_cast<int>(cause)];
}

std::vector<LaneExplanation> accounts(const AnyPair& pair, Verdict truth, std::span<const Lane* const> lanes) {
  std::vector<LaneExplanation> result;
  if (truth == Verdict::declined) return result;
  std::map<std::pair<const AlgorithmInfo*, bool>, oracle::Exactly> exactly;
  for (const Lane* lane : lanes) {
    const Own own = own_of(*lane, pair, truth);
    const Verdict verdict = decide_lane(*lane, own.pair);
    if (verdict == truth || is_by_convention(*lane, verdict, pair)) continue;
    if (own.explains(verdict, truth)) {
      result.push_back(account_of_stored(*lane, verdict, pair.doubles, *own.pair.floats, truth));
      continue;
    }
    if (lane->foreign || lane->under) {
      const auto account = lane->foreign ? account_of_foreign : account_of_policy;
      result.push_back(account(*lane, verdict, own.pair, own.truth));
      continue;
    }
    const auto same = std::find_if(result.begin(), result.end(), [&](const LaneExplanation& other) {
      return other.verdict == verdict && same_run(*other.lane, *lane);
    });
    if (same != result.end()) {
      LaneExplanation copy = *same;
      copy.lane = lane;
      result.push_back(std::move(copy));
      continue;
    }
    const std::pair key(lane->info, own.pair.floats.has_value());
    auto found = exactly.find(key);
    if (found == exactly.end())
      found = exactly.emplace(key, oracle::decide_exactly(lane->algorithm, own.pair.doubles)).first;
    result.push_back(account_of(*lane, verdict, own.pair, own.truth, found->second));
  }
  return result;
}

Explanation explain(const AnyPair& pair, std::span<const Lane* const> lanes) {
  Explanation result{pair, oracle::truth(pair), {}, {}};
  const Verdict truth = result.truth.verdict;
  result.lanes = accounts(pair, truth, lanes);
  for (const Lane* lane : lanes) {
    if (lane->outside == 0 || truth == Verdict::declined) continue;
    const Verdict verdict = decide_lane(*lane, pair);
    if (verdict != truth && is_by_convention(*lane, verdict, pair)) result.outside.push_back(lane);
  }
  // Neighbours of the pair as float32 stores it, and of the pair itself.
  std::tuple<std::optional<Neighbours<float>>, std::optional<Neighbours<double>>> around;
  std::map<std::pair<const AlgorithmInfo*, bool>, int> bits;
  for (LaneExplanation& lane : result.lanes) {
    // If every verdict may time out or need a new process, only the pair itself is tried.
    if (lane.slow) continue;
    const AnyPair own = seen_by(*lane.lane, pair);
    if (!lane.by_experiment()) {
      const std::pair key(lane.lane->info, own.floats.has_value());
      auto found = bits.find(key);
      if (found == bits.end())
        found = bits.emplace(key, bits_needed(lane.lane->algorithm, lane.exactly, own, truth)).first;
      const bool f32 = lane.lane->scalar == Scalar::f32;
      const int needed = f32 || found->second == 0 ? found->second : std::max(found->second, 53);
      lane.bits_needed = needed;
      lane.bits_alone =
          needed > 0 && oracle::decide_with_bits(lane.lane->algorithm, own.doubles, needed, lane.lane->scalar) == truth;
    }
    visit(own, [&]<class Real>(const BasicPair<Real>& stored) {
      auto& neighbours = std::get<std::optional<Neighbours<Real>>>(around);
      if (!neighbours) neighbours.emplace(stored, truth);
      add_surroundings(lane, truth, *neighbours);
    });
  }
  return result;
}

}  // namespace graze::analysis
