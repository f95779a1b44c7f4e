// SPDX-License-Identifier: Apache-2.0
#include "analysis/deciding.h"

#include <cmath>
#include <optional>

namespace graze::analysis {
namespace {

// The lane's run with some of its comparisons corrected.
struct Corrected {
  std::vector<std::size_t> comparisons;  // indices of the corrected comparisons, in order
  Path path;                             // outcomes of the corrected run
};

class Search {
 public:
  Search(const Lane& lane, const AnyPair& pair, Verdict truth, Contraction rule)
      : lane_(lane), pair_(pair), truth_(truth), rule_(rule) {}

  // Tries sets of one comparison first, then larger sets. Sets of equal size are tried in order of execution.
  std::optional<Corrected> smallest(const Path& lane_path) const {
    std::vector<Corrected> sets{{{}, lane_path}};
    for (int size = 1; size <= kMostDeciding; ++size) {
      std::vector<Corrected> larger;
      for (const Corrected& set : sets) {
        const Path exact = oracle::exact_outcomes(lane_.algorithm, pair_.doubles, set.path);
        for (std::size_t i = set.comparisons.empty() ? 0 : set.comparisons.back() + 1; i < exact.size(); ++i) {
          if (set.path[i] == exact[i]) continue;
          Path lead(set.path.begin(), set.path.begin() + static_cast<std::ptrdiff_t>(i));
          lead.push_back(exact[i]);
          const Trace<double> run = run_led(lane_, pair_, rule_, lead);
          Corrected next{set.comparisons, path_of(run)};
          next.comparisons.push_back(i);
          if (run.verdict == truth_) return next;
          if (size < kMostDeciding) larger.push_back(std::move(next));
        }
      }
      sets = std::move(larger);
    }
    return std::nullopt;
  }

  // Describes each comparison of the set in the run in which the set's earlier comparisons are corrected.
  std::vector<Decider> told(const Corrected& set, const WithoutCause& without_cause) const {
    std::vector<Decider> result;
    for (const std::size_t comparison : set.comparisons) {
      const Path lead = result.empty() ? Path() : result.back().corrected();
      const Trace<double> run = run_led(lane_, pair_, rule_, lead);
      const Path path = path_of(run);
      std::size_t place = 0;
      for (std::size_t before = 0; before < comparison || !run.seen[place].compared; ++place)
        before += run.seen[place].compared;
      const Seen<double>& seen = run.seen[place];
      const oracle::ExactStep exact = oracle::exact_steps(lane_.algorithm, lane_.scalar, pair_.doubles, run)[place];
      result.push_back(
          {place, seen, exact, path, Path(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(comparison)), true});
      result.back().by_cause = is_by_cause(result.back(), without_cause);
    }
    return result;
  }

 private:
  const Lane& lane_;
  const AnyPair& pair_;
  Verdict truth_;
  Contraction rule_;
};

}  // namespace

bool is_by_cause(const Decider& decider, const WithoutCause& without_cause) {
  if (!without_cause || !std::isfinite(decider.seen.left) || !std::isfinite(decider.seen.right)) return true;
  return without_cause(decider.path).seen[decider.place].held == decider.exact.held;
}

std::vector<Decider> deciding_comparisons(const Lane& lane, const AnyPair& pair, Verdict truth, const Replay& replay,
                                          const WithoutCause& without_cause) {
  const Search search(lane, pair, truth, replay.rule);
  const std::optional<Corrected> found = search.smallest(path_of(replay.run));
  return found ? search.told(*found, without_cause) : std::vector<Decider>();
}

}  // namespace graze::analysis
