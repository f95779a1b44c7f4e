// SPDX-License-Identifier: Apache-2.0
#include "fuzz/minimise/minimise.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

#include "analysis/convention.h"
#include "analysis/experiments.h"
#include "analysis/lane_trace.h"
#include "backends/backends.h"
#include "core/lanes/verdicts.h"
#include "core/margin/margin.h"
#include "core/relation_of.h"
#include "core/simplify/moves.h"
#include "oracle/truth.h"

namespace graze::fuzz {
namespace {

constexpr std::size_t kBlockPairs = 64;  // one word of verdict bits

constexpr int kMostLate = 3;  // after this many timeouts a case ends

// Returns the pairs (of at most 64) on which every lane gives the failure's verdict. Wrong lanes decide first, because
// they leave the fewest pairs for the others.   late: increased by the number of timeouts of foreign code.
template <class Real>
std::vector<BasicPair<Real>> decided_alike(const Failure& failure, std::vector<BasicPair<Real>> pairs,
                                           int* late = nullptr) {
  for (const bool wrong : {true, false}) {
    for (std::size_t l = 0; l < failure.lanes.size() && !pairs.empty(); ++l) {
      if (is_wrong(failure.verdicts[l], failure.truth.verdict) != wrong) continue;
      const std::vector<Verdict> said = analysis::verdicts_seen_by(*failure.lanes[l], failure.on_host[l], pairs);
      if (late) *late += static_cast<int>(std::count(said.begin(), said.end(), Verdict::timed_out));
      std::size_t i = 0;
      std::erase_if(pairs, [&](const auto&) { return said[i++] != failure.verdicts[l]; });
    }
  }
  return pairs;
}

// Decides in one thread at a time if there is a device, because a device requires that.
std::vector<Verdict> decide_in_turn(const SelectedLanes& under_test, const AnyPair& pair) {
  static std::mutex mutex;
  std::vector<const Lane*> apart;
  std::unique_lock lock(mutex, std::defer_lock);
  if (under_test.device) lock.lock();
  return decide(under_test, pair, apart);
}

// Replaces the worst pair so far with this one if its margin is larger, which bounds on it nearly always decide.
template <class Real>
void keep_worst(Minimised& result, const BasicPair<Real>& pair, Verdict verdict) {
  if constexpr (std::is_same_v<Real, float>) {
    const MarginBounds bounds = margin_bounds(pair, verdict);
    if (std::ldexp(bounds.hi, -log2_ulp(pair)) <= result.worst_ulps) return;
  }
  const double ulps = std::fabs(oracle::truth(pair).margin_ulps);
  if (ulps <= result.worst_ulps) return;
  result.worst = pair;
  result.worst_ulps = ulps;
}

bool in_range(const Failure& failure, const AnyPair& pair) {
  return !analysis::leaves_exponents(failure.first_wrong(pair), pair);
}

// A quick check before the expensive computation of the cause. Returns false if the pair cannot have the reason.
bool may_have_reason(const Failure& failure, const Reason& reason, const AnyPair& pair) {
  const bool by_range = reason.cause == analysis::Cause::overflow || reason.cause == analysis::Cause::underflow;
  if (!reason.in_range && !by_range) return true;
  return in_range(failure, pair) == reason.in_range;
}

// Whether the pairs have the same type and bits.
bool same_bits(const AnyPair& l, const AnyPair& r) {
  return l.floats.has_value() == r.floats.has_value() && !simpler_coordinates(l.doubles, r.doubles) &&
         !simpler_coordinates(r.doubles, l.doubles);
}

// Applies the move from `before` to `after` `times` times. If the move scaled all changed coordinates by one power of
// two, they are scaled `times` times; otherwise they are moved `times` times as far.   Returns: nothing if a coordinate
// is not finite.
template <class Real>
std::optional<BasicPair<Real>> repeated(const BasicPair<Real>& before, const BasicPair<Real>& after,
                                        std::int64_t times) {
  const Real *from = coordinates(before), *to = coordinates(after);
  std::optional<int> exponent;  // of the power of two; 0 if there is none
  for (int i = 0; i < kCoordinates; ++i) {
    if (to[i] == from[i]) continue;
    const int apart = from[i] == 0 || to[i] == 0 ? 0 : std::ilogb(to[i]) - std::ilogb(from[i]);
    if (std::ldexp(from[i], apart) != to[i] || (exponent && *exponent != apart)) exponent = 0;
    if (!exponent) exponent = apart;
  }
  const bool scaled = exponent && *exponent != 0;
  if (scaled && times > (std::is_same_v<Real, float> ? 300 : 2200)) return {};  // larger than any exponent
  BasicPair<Real> result = before;
  for (int i = 0; i < kCoordinates; ++i) {
    if (to[i] == from[i]) continue;
    const double there = scaled ? std::ldexp(double{from[i]}, *exponent * static_cast<int>(times))
                                : from[i] + static_cast<double>(times) * (double{to[i]} - from[i]);
    coordinates(result)[i] = static_cast<Real>(there);
  }
  if (!is_finite(result)) return {};
  return result;
}

// The index of the first wrong lane, ignoring lanes excused by their convention; the number of lanes if there is none.
template <class Real>
std::size_t wrong_at(const Failure& failure, const BasicPair<Real>& pair) {
  const Relation& truth = failure.truth;
  std::size_t l = 0;
  while (l < failure.lanes.size() && (!is_wrong(failure.verdicts[l], truth.verdict) ||
                                      analysis::by_convention(*failure.lanes[l], failure.verdicts[l], pair, truth)))
    ++l;
  return l;
}

template <class Real>
bool counts(const Failure& failure, const BasicPair<Real>& pair) {
  return wrong_at(failure, pair) < failure.lanes.size();
}

struct FoundCause {
  analysis::Cause cause;
  bool settled;  // used only for foreign code
};

FoundCause found_cause(const Lane& lane, const AnyPair& pair, Verdict truth) {
  const bool stored = !pair.floats && lane.scalar == Scalar::f32;  // the lane decides the rounded pair
  if (!lane.foreign || stored) return {analysis::cause_of(lane, pair, truth), false};
  const Verdict verdict = analysis::decide_lane(lane, pair);
  const analysis::Experiment found =
      visit(pair, [&](const auto& own) { return analysis::experiment(lane, verdict, own, truth); });
  return {found.cause, found.settled};
}

template <class Real>
struct Walk {
  using PairOf = BasicPair<Real>;

  const Failure& failure;
  std::span<const Minimised> known;
  std::size_t most;
  Minimised result;
  std::vector<PairOf> way;  // from the first pair to the current one
  std::size_t sure = 0;     // index of the last pair in `way` known to have the cause
  bool ask_all = false;     // whether to check every pair's cause before taking it
  bool open;                // foreign code whose cause is not settled on the first pair
  int late = 0;             // how many verdicts of foreign code timed out
  bool prompt = false;      // whether the foreign code has decided a block in time

  Walk(const Failure& of, const PairOf& pair, std::span<const Minimised> results, std::size_t limit)
      : Walk(of, pair, results, limit, found_cause(of.first_wrong(pair), pair, of.truth.verdict)) {}

  Walk(const Failure& of, const PairOf& pair, std::span<const Minimised> results, std::size_t limit, FoundCause first)
      : failure(of),
        known(results),
        most(limit),
        result{.pair = pair, .first_cause = first.cause, .reason = {first.cause, in_range(of, pair)}, .worst = pair},
        way{pair},
        open(of.first_wrong(pair).foreign && !first.settled) {
    result.worst_ulps = std::fabs(oracle::truth(pair).margin_ulps);
  }

  bool spent() const { return result.moved + kLeastMoved >= most || late >= kMostLate; }

  bool has_cause(const PairOf& pair) {
    result.moved += kMovedPerCause;
    const Lane& lane = failure.first_wrong(pair);
    const FoundCause found = found_cause(lane, pair, failure.truth.verdict);
    const analysis::Cause first = result.reason.cause;
    if (found.cause == first) return true;
    // Only a guessed cause may be replaced with one that a simpler pair settles. Other causes come from experiments
    // that made the verdict right.
    const bool guessed = first == analysis::Cause::rounding || first == analysis::Cause::logic;
    const bool is_order = found.cause == analysis::Cause::order_dependent;
    return open && guessed && (found.settled || (is_order && first == analysis::Cause::rounding));
  }

  // Makes the candidate the current pair if it fails in the same way and for the same reason.
  // Requires: the candidate has the failure's verdicts.
  bool take(const PairOf& candidate) {
    if (!failure.has_shape_of(candidate) || !counts(failure, candidate)) return false;
    if (!may_have_reason(failure, result.reason, candidate)) return false;
    if (ask_all && !has_cause(candidate)) return false;
    way.push_back(candidate);
    result.reason.in_range = in_range(failure, candidate);
    keep_worst(result, candidate, failure.truth.verdict);
    return true;
  }

  bool is_simpler(const PairOf& candidate) const {
    const std::uint64_t now = simplicity_counts(way.back()), counts = simplicity_counts(candidate, now);
    return counts < now || (counts == now && simpler_coordinates(candidate, way.back()));
  }

  // Repeats the last move 2, 4, 8, … times at once while the pair gets simpler, then bisects.
  void repeat() {
    const PairOf before = way[way.size() - 2], once = way.back();
    const auto works = [&](std::int64_t times) {
      ++result.moved;
      const std::optional<PairOf> candidate = repeated(before, once, times);
      return candidate && is_simpler(*candidate) && !decided_alike<Real>(failure, {*candidate}, &late).empty() &&
             take(*candidate);
    };
    constexpr std::int64_t kMostTimes = std::int64_t{1} << 52;
    std::int64_t times = 1;
    while (times < kMostTimes && works(2 * times)) times *= 2;
    for (std::int64_t more = times / 2; more > 0; more /= 2) {
      if (works(times + more)) times += more;
    }
  }

  // Tries all moves of this kind on the current pair, and takes the simplest result that fails in the same way, if any.
  bool improve(int kind) {
    const std::vector<PairOf> simpler = simpler_moves(way.back(), kind, result.moved);
    for (auto first = simpler.begin(); first != simpler.end();) {
      if (spent()) return false;
      const std::size_t at_once =
          failure.lanes.front()->foreign ? analysis::foreign_at_once(prompt && late == 0) : kBlockPairs;
      const auto last = first + std::min(static_cast<std::ptrdiff_t>(at_once), simpler.end() - first);
      for (const PairOf& candidate : decided_alike<Real>(failure, {first, last}, &late)) {
        if (spent()) return false;
        if (!take(candidate)) continue;
        repeat();
        return true;
      }
      first = last;
      prompt = true;
    }
    result.single_moves += simpler.size();
    return false;
  }

  bool ends_in_known() {
    const AnyPair last = way.back();
    const auto met = std::find_if(known.begin(), known.end(), [&](const Minimised& other) {
      return other.one_minimal && same_bits(other.pair, last);
    });
    if (met == known.end()) return false;
    result.single_moves = met->single_moves;
    return result.one_minimal = true;
  }

  void go_down() {
    result.one_minimal = false;
    result.single_moves = 0;
    if (ends_in_known()) return;
    int in_vain = 0;
    for (int kind = 0; in_vain < kMoveKinds; kind = (kind + 1) % kMoveKinds) {
      if (spent()) return;
      in_vain = improve(kind) ? 0 : in_vain + 1;
      if (in_vain > 0) continue;
      result.single_moves = 0;
      if (ends_in_known()) return;
    }
    result.one_minimal = !spent();
  }

  bool ends_with_cause() { return sure == way.size() - 1 || has_cause(way.back()); }

  // Goes back to a pair that has the cause and whose successor lacks it.   Requires: the last pair lacks the cause.
  void go_back() {
    std::size_t has = sure, lacks = way.size() - 1;
    while (lacks - has > 1) {
      const std::size_t middle = has + (lacks - has) / 2;
      (has_cause(way[middle]) ? has : lacks) = middle;
    }
    way.resize(has + 1);
    result.reason.in_range = in_range(failure, way.back());
  }

  // First simplifies the pair without computing causes, because they are expensive. If the result lacks the cause, goes
  // back to a pair with the cause and simplifies it, checking the cause of each step. Then simplifies again, without
  // computing causes. Repeats this until nothing changes, so that minimising the result again would change nothing.
  void run() {
    go_down();
    while (!ends_with_cause()) {
      const std::size_t before = sure;
      go_back();
      ask_all = true;
      go_down();
      sure = way.size() - 1;
      if (spent() || sure == before) return;
      ask_all = false;
      go_down();
    }
  }
};

}  // namespace

template <class Real>
bool Failure::has_shape_of(const BasicPair<Real>& pair) const {
  return relation_of(pair) == truth && analysis::nesting_of(pair, truth) == nesting;
}

const Lane& Failure::first_wrong(const AnyPair& pair) const {
  return *lanes.at(visit(pair, [&](const auto& own) { return wrong_at(*this, own); }));
}

Reason reason_of(const Failure& failure, const AnyPair& pair) {
  return {analysis::cause_of(failure.first_wrong(pair), pair, failure.truth.verdict), in_range(failure, pair)};
}

bool fails_for_reason(const Failure& failure, const Reason& reason, const AnyPair& pair) {
  return fails_alike(failure, pair) && may_have_reason(failure, reason, pair) &&
         analysis::cause_of(failure.first_wrong(pair), pair, failure.truth.verdict) == reason.cause;
}

std::vector<Failure> failures_of(const SelectedLanes& under_test, const AnyPair& pair) {
  std::vector<Failure> failures;
  if (!is_finite(pair.doubles)) return failures;
  const auto of_pair = visit(pair, [](const auto& own) {
    const Relation relation = relation_of(own);
    return std::pair(relation, analysis::nesting_of(own, relation));
  });
  const std::vector<Verdict> verdicts = decide_in_turn(under_test, pair);
  analysis::for_each_subject(under_test.lanes, [&](std::size_t first, std::size_t count) {
    Failure failure{of_pair.first, of_pair.second, {}, {}, {}};
    for (std::size_t l = first; l < first + count; ++l) {
      const Lane& lane = *under_test.lanes[l];
      const DecideBlock on_host = backends::on_host(lane);
      if (!on_host)
        throw std::runtime_error("cannot minimise with " + lane.id + ": it has no twin; choose other --lanes");
      failure.lanes.push_back(&lane);
      failure.on_host.push_back(on_host);
      failure.verdicts.push_back(verdicts[l]);
    }
    if (!visit(pair, [&](const auto& own) { return counts(failure, own); })) return;
    if (!failure.lanes.front()->foreign && !fails_alike(failure, pair)) {
      throw std::runtime_error("cannot minimise with the twins of " + std::string(failure.lanes.front()->info->id) +
                               ": their verdicts differ from those of the device");
    }
    failures.push_back(std::move(failure));
  });
  return failures;
}

template bool Failure::has_shape_of(const Pair&) const;
template bool Failure::has_shape_of(const DoublePair&) const;

bool fails_alike(const Failure& failure, const AnyPair& pair) {
  return visit(pair, [&](const auto& own) {
    return !decided_alike(failure, std::vector{own}).empty() && failure.has_shape_of(own);
  });
}

analysis::Signature signature_of(const Failure& failure, const AnyPair& pair) {
  const Bucket bucket = visit(pair, [&](const auto& own) { return oracle::margin_bucket(own, failure.truth.verdict); });
  return analysis::signature(failure.truth, failure.nesting, bucket, failure.lanes, failure.verdicts);
}

bool can_shrink(const Failure& failure) {
  return std::none_of(failure.verdicts.begin(), failure.verdicts.end(),
                      [](Verdict verdict) { return verdict == Verdict::timed_out || verdict == Verdict::unstable; });
}

std::size_t most_moved(const Failure& failure) {
  const bool crashes =
      std::find(failure.verdicts.begin(), failure.verdicts.end(), Verdict::crashed) != failure.verdicts.end();
  return crashes ? kMostMovedCrashing : kMostMoved;
}

Minimised minimise(const Failure& failure, const AnyPair& pair, std::span<const Minimised> known,
                   std::optional<std::size_t> most) {
  return visit(pair, [&](const auto& own) {
    Walk walk(failure, own, known, most.value_or(most_moved(failure)));
    walk.result.one_minimal = false;
    if (!can_shrink(failure)) return walk.result;
    walk.run();
    walk.result.pair = walk.way.back();
    const Lane& lane = failure.first_wrong(walk.result.pair);
    if (lane.foreign && walk.way.size() > 1)
      walk.result.reason.cause = analysis::cause_of(lane, walk.result.pair, failure.truth.verdict);
    return walk.result;
  });
}

void confirm(const SelectedLanes& under_test, const Failure& failure, const AnyPair& pair) {
  const Relation by_oracle = oracle::truth(pair);
  if (by_oracle != failure.truth) throw oracle::OracleMismatch("the minimiser's truth and the oracle's differ");
  if (!can_shrink(failure)) return;  // the pair is still the original, so there is nothing to confirm
  const std::vector<Failure> failures = failures_of(under_test, pair);
  if (std::find(failures.begin(), failures.end(), failure) == failures.end())
    throw std::runtime_error("the minimised pair does not fail like the original: this is a bug in Graze");
}

}  // namespace graze::fuzz
