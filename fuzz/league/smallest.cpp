// SPDX-License-Identifier: Apache-2.0
#include "fuzz/league/smallest.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "analysis/convention.h"
#include "analysis/tally.h"
#include "core/lanes/verdicts.h"
#include "cuda/twin/twin.h"
#include "fuzz/minimise/kinds.h"
#include "fuzz/minimise/minimise.h"
#include "subjects/subjects.h"

namespace graze::fuzz {
namespace {

constexpr std::size_t kMostMovedHere = 150'000;  // small, because there may be hundreds of failures

// A crash costs a new process, so a lane that crashes gets fewer moves. A timeout takes the whole time limit, and an
// unstable verdict may not recur, so neither is minimised.
std::size_t most_moved(const Candidate& candidate) {
  if (candidate.says == Verdict::timed_out || candidate.says == Verdict::unstable) return 0;
  return candidate.lane_dies ? kLeastMoved + 10'000 : kMostMovedHere;
}

SelectedLanes alone(const Lane& lane) {
  SelectedLanes result;
  result.lanes.push_back(&lane);
  result.on_host.push_back(lane.decide);
  return result;
}

bool is_clear(const oracle::Truth& truth) {
  return shape_name(truth.hulls) == "general" && std::fabs(truth.margin_ulps) >= std::ldexp(1.0, kClearExponent);
}

LeagueFailure minimised(const Candidate& candidate) {
  LeagueFailure result{candidate.lane, candidate.shape, candidate.says, candidate.pair, {}, false};
  if (most_moved(candidate) == 0) return result;
  try {
    const SelectedLanes under_test = alone(*candidate.lane);
    const std::vector<Failure> failures = failures_of(under_test, candidate.pair);
    if (failures.empty()) return result;
    const Minimised found = minimise(failures.front(), candidate.pair, {}, most_moved(candidate));
    confirm(under_test, failures.front(), found.pair);
    if (candidate.shape == kClear && !is_clear(oracle::truth(found.pair))) return result;
    result.pair = found.pair;
    result.minimised = true;
  } catch (const oracle::OracleMismatch&) {
    throw;
  } catch (const std::runtime_error&) {  // the failure does not always occur, so the original pair is kept
  }
  return result;
}

// Whether this pair is within the lane's contract, and the lane fails on it with the failure's shape and verdict.
bool fails_so(const LeagueFailure& failure, const AnyPair& pair) {
  const Verdict verdict = visit(pair, [&](const auto& own) { return decide_one(failure.lane->decide, own); });
  const oracle::Truth truth = oracle::truth(pair);
  const bool shaped = failure.shape == kClear ? is_clear(truth) : shape_name(truth.hulls) == failure.shape;
  return shaped && verdict != truth.verdict && verdict == failure.verdict &&
         !analysis::by_convention(*failure.lane, verdict, pair, truth);
}

}  // namespace

template <class Real>
std::vector<Verdict> verdicts_in_fresh_process(const Lane& lane, const std::vector<BasicPair<Real>>& pairs) {
  if (pairs.empty()) return {};
  std::unique_ptr<subjects::ForeignProcesses> fresh;
  if (lane.foreign) fresh = subjects::processes_of(lane).anew();
  return verdicts_of(fresh ? DecideBlock(*fresh) : lane.decide, pairs);
}

template std::vector<Verdict> verdicts_in_fresh_process(const Lane&, const std::vector<Pair>&);
template std::vector<Verdict> verdicts_in_fresh_process(const Lane&, const std::vector<DoublePair>&);

void Smallest::add(std::string_view shape, Verdict says, const AnyPair& pair) {
  const std::pair<std::string, Verdict> key{shape, says};
  const auto found = pairs_.find(key);
  if (found == pairs_.end()) {
    pairs_.emplace(key, std::pair(simplicity(pair), pair));
  } else if (simplicity_counts(pair.doubles, found->second.first.counts) <= found->second.first.counts) {
    if (const Simplicity now = simplicity(pair); now < found->second.first) found->second = {now, pair};
  }
}

void Smallest::add_candidates(const Lane& lane, std::vector<Candidate>& candidates) const {
  const bool dies = std::any_of(pairs_.begin(), pairs_.end(), [](const auto& row) {
    return row.first.second == Verdict::crashed || row.first.second == Verdict::timed_out;
  });
  for (const auto& [key, pair] : pairs_) candidates.push_back({&lane, key.first, key.second, pair.second, dies});
}

std::vector<LeagueFailure> smallest_failures(const std::vector<Candidate>& candidates, std::uint64_t& not_repeated) {
  std::vector<const Candidate*> first;
  std::set<std::tuple<const AlgorithmInfo*, std::string, Verdict>> seen;
  for (const Candidate& candidate : candidates) {
    if (seen.emplace(candidate.lane->info, candidate.shape, candidate.says).second) first.push_back(&candidate);
  }
  std::vector<LeagueFailure> failures(first.size());
  tbb::parallel_for(std::size_t{0}, first.size(), [&](std::size_t i) { failures[i] = minimised(*first[i]); });

  std::vector<LeagueFailure> shared = failures;
  tbb::parallel_for(std::size_t{0}, failures.size(), [&](std::size_t i) {
    if (!failures[i].minimised) return;
    Simplicity least = simplicity(failures[i].pair);
    for (const LeagueFailure& other : failures) {
      if (!other.minimised || other.shape != failures[i].shape || other.verdict != failures[i].verdict) continue;
      const Simplicity its = simplicity(other.pair);
      if (!(its < least) || !fails_so(failures[i], other.pair)) continue;
      least = its;
      shared[i].pair = other.pair;
    }
  });

  std::vector<char> shown(shared.size());
  tbb::parallel_for(std::size_t{0}, shared.size(), [&](std::size_t i) {
    LeagueFailure& failure = shared[i];
    failure.truth = oracle::truth(failure.pair);
    const Verdict again = visit(failure.pair, [&](const auto& own) {
      return verdicts_in_fresh_process(*failure.lane, std::vector{own}).front();
    });
    shown[i] = again == failure.verdict && again != failure.truth.verdict;
  });
  std::vector<LeagueFailure> result;
  for (std::size_t i = 0; i < shared.size(); ++i) {
    if (shown[i]) result.push_back(shared[i]);
  }
  not_repeated = shared.size() - result.size();
  return result;
}

}  // namespace graze::fuzz
