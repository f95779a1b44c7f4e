// SPDX-License-Identifier: Apache-2.0
#include "fuzz/minimise/minimise.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "core/exact/exact.h"
#include "core/margin/margin.h"
#include "cuda/twin/twin.h"
#include "fuzz/minimise/moves.h"
#include "oracle/truth.h"

namespace graze::fuzz {
namespace {

constexpr std::size_t kBlockPairs = 64;  // one word of verdicts

// Of at most 64 pairs, those that get the failure's verdict from every lane. The lanes that are wrong come first: they
// leave the fewest pairs to the others.
std::vector<Pair> decided_alike(const Failure& failure, std::vector<Pair> pairs) {
  for (const bool wrong : {true, false}) {
    for (std::size_t l = 0; l < failure.lanes.size() && !pairs.empty(); ++l) {
      if ((failure.verdicts[l] != failure.truth.verdict) != wrong) continue;
      std::uint64_t intersects = 0, declined = 0;
      failure.on_host[l](pairs.data(), pairs.size(), &intersects, &declined);
      const std::uint64_t alike = failure.verdicts[l] == Verdict::declined     ? declined
                                  : failure.verdicts[l] == Verdict::intersects ? intersects & ~declined
                                                                               : ~intersects & ~declined;
      std::size_t i = 0;
      std::erase_if(pairs, [&](const Pair&) { return (alike >> i++ & 1u) == 0; });
    }
  }
  return pairs;
}

// A device takes one thread at a time.
std::vector<Verdict> decide_in_turn(const LanesUnderTest& under_test, const Pair& pair) {
  static std::mutex mutex;
  std::vector<const Lane*> apart;
  std::unique_lock lock(mutex, std::defer_lock);
  if (under_test.device) lock.lock();
  return decide(under_test, pair, apart);
}

// Replaces the worst pair so far by this one, if its margin is larger. Bounds decide nearly always.
void keep_worst(Minimised& result, const Pair& pair, Verdict verdict) {
  const MarginBounds bounds = margin_bounds(pair, verdict);
  if (std::ldexp(bounds.hi, -log2_ulp(pair)) <= result.worst_ulps) return;
  const double ulps = std::fabs(oracle::truth(pair).margin_ulps);
  if (ulps <= result.worst_ulps) return;
  result.worst = pair;
  result.worst_ulps = ulps;
}

}  // namespace

Judged judged(const Pair& pair) {
  const exact::Relation r = exact::relation(&pair.a[0].x, &pair.b[0].x);
  return {r.intersects ? Verdict::intersects : Verdict::disjoint, static_cast<Contact>(r.contact + 1),
          oracle::Shape{r.dimension_a, r.dimension_b, r.coplanar}, r.margin_sign};
}

std::vector<Failure> failures_of(const LanesUnderTest& under_test, const Pair& pair) {
  std::vector<Failure> failures;
  if (!is_finite(pair)) return failures;
  const Judged truth_of_pair = judged(pair);
  const std::vector<Verdict> verdicts = decide_in_turn(under_test, pair);
  analysis::for_each_subject(under_test.lanes, [&](std::size_t first, std::size_t count) {
    Failure failure{truth_of_pair, {}, {}, {}};
    bool wrong = false;
    for (std::size_t l = first; l < first + count; ++l) {
      const Lane& lane = *under_test.lanes[l];
      const DecideBlock on_host = cuda::block_on_host(lane);
      if (!on_host) throw std::runtime_error(lane.id + ": expected a twin to minimise with, found none");
      failure.lanes.push_back(&lane);
      failure.on_host.push_back(on_host);
      failure.verdicts.push_back(verdicts[l]);
      wrong = wrong || verdicts[l] != truth_of_pair.verdict;
    }
    if (!wrong) return;
    if (!fails_alike(failure, pair)) {
      throw std::runtime_error(std::string(failure.lanes.front()->info->id) +
                               ": expected the twins to say what the device says, found that they differ");
    }
    failures.push_back(std::move(failure));
  });
  return failures;
}

bool fails_alike(const Failure& failure, const Pair& pair) {
  return !decided_alike(failure, {pair}).empty() && judged(pair) == failure.truth;
}

analysis::Signature signature_of(const Failure& failure, const Pair& pair) {
  return analysis::signature(failure.truth.contact, failure.truth.shape,
                             oracle::margin_bucket(pair, failure.truth.verdict), failure.truth.verdict, failure.lanes,
                             failure.verdicts);
}

std::vector<Pair> simpler_moves(const Pair& pair, int kind) {
  thread_local std::vector<Pair> moved;
  moved.clear();
  append_moves(pair, kind, moved);
  const std::uint64_t now = simplicity_counts(pair);
  struct Simpler {
    std::uint64_t counts;
    const Pair* pair;
  };
  thread_local std::vector<Simpler> order;
  order.clear();
  for (const Pair& m : moved) {
    const std::uint64_t counts = simplicity_counts(m, now);
    if (counts < now || (counts == now && simpler_coordinates(m, pair))) order.push_back({counts, &m});
  }
  std::sort(order.begin(), order.end(), [](const Simpler& l, const Simpler& r) {
    return l.counts != r.counts ? l.counts < r.counts : simpler_coordinates(*l.pair, *r.pair);
  });
  std::vector<Pair> simpler;
  simpler.reserve(order.size());
  for (const Simpler& next : order) {
    if (simpler.empty() || simpler_coordinates(simpler.back(), *next.pair) ||
        simpler_coordinates(*next.pair, simpler.back()))
      simpler.push_back(*next.pair);
  }
  return simpler;
}

Minimised minimise(const Failure& failure, const Pair& pair) {
  Minimised result{pair, 0, pair, std::fabs(oracle::truth(pair).margin_ulps)};
  // The simplest pair that a kind of move makes of the current one and that fails alike, if any.
  const auto improve = [&](int kind) {
    const std::vector<Pair> simpler = simpler_moves(result.pair, kind);
    for (auto first = simpler.begin(); first != simpler.end();) {
      const auto last = first + std::min<std::ptrdiff_t>(kBlockPairs, simpler.end() - first);
      for (const Pair& candidate : decided_alike(failure, {first, last})) {
        if (judged(candidate) != failure.truth) continue;
        result.pair = candidate;
        keep_worst(result, candidate, failure.truth.verdict);
        return true;
      }
      first = last;
    }
    result.single_moves += simpler.size();
    return false;
  };
  int in_vain = 0;
  for (int kind = 0; in_vain < kMoveKinds; kind = (kind + 1) % kMoveKinds) {
    in_vain = improve(kind) ? 0 : in_vain + 1;
    if (in_vain == 0) result.single_moves = 0;
  }
  return result;
}

void confirm(const LanesUnderTest& under_test, const Failure& failure, const Pair& pair) {
  const oracle::Truth t = oracle::truth(pair);
  const Judged by_oracle{t.verdict, t.contact, oracle::shape(pair), (t.margin > 0) - (t.margin < 0)};
  if (by_oracle != failure.truth) throw oracle::OracleApart("the minimiser's truth and the oracle's differ");
  const std::vector<Failure> failures = failures_of(under_test, pair);
  if (std::find(failures.begin(), failures.end(), failure) == failures.end())
    throw std::runtime_error("expected the minimised pair to fail as the original does, found that it does not");
}

}  // namespace graze::fuzz
