// SPDX-License-Identifier: Apache-2.0
#include "analysis/verdicts_apart.h"

#include "analysis/convention.h"
#include "analysis/over_threads.h"
#include "core/lanes/verdicts.h"
#include "core/relation_of.h"

namespace graze::analysis {

std::vector<VerdictsApart> verdicts_apart(const TwoDeciders& deciders, const std::vector<strata::PairSource>& sources,
                                          int threads,
                                          const std::function<bool(const AnyPair&, const AnyPair&)>& simpler) {
  constexpr std::uint64_t kPairsDecided = 64;
  const std::vector<SourceBlock> blocks = blocks_of(sources, kPairsDecided);
  const auto pair_at = [&](const PairPlace& place) {
    return sources[static_cast<std::size_t>(place.source)].any_pair(place.index);
  };
  // Orders equally simple pairs by their places, so that the result does not depend on the threads.
  const auto keep_simplest = [&](std::optional<PairPlace>& kept, const PairPlace& found) {
    if (!kept) {
      kept = found;
      return;
    }
    const AnyPair old_pair = pair_at(*kept), pair = pair_at(found);
    if (simpler(pair, old_pair) || (!simpler(old_pair, pair) && found < *kept)) kept = found;
  };
  const auto count_block = [&](std::size_t b, std::vector<VerdictsApart>& result) {
    const SourceBlock& block = blocks[b];
    const auto source = static_cast<std::size_t>(block.source);
    const strata::PairBlock pairs = strata::pairs_of(sources[source], block.first, block.count);
    const auto verdicts_by = [&](const DecideBlock& decide) {
      return pairs.in_doubles() && decide.decides_doubles() ? verdicts_of(decide, pairs.doubles)
                                                            : verdicts_of(decide, pairs.floats);
    };
    const std::vector<Verdict> verdicts[2] = {verdicts_by(deciders.decide[0]), verdicts_by(deciders.decide[1])};
    VerdictsApart& to = result[source];
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const AnyPair pair = pairs[i];
      const Relation truth = visit(pair, [](const auto& own) { return relation_or_declined(own); });
      if (truth.verdict == Verdict::declined) continue;
      ++to.pairs;
      bool wrong[2];
      for (int lane = 0; lane < 2; ++lane) {
        const Verdict verdict = verdicts[lane][i];
        wrong[lane] = false;
        if (verdict == truth.verdict) continue;
        const bool excused = by_convention(*deciders.lanes[lane], verdict, pair, truth);
        ++(excused ? to.of[lane].by_convention : to.of[lane].of(verdict));
        wrong[lane] = !excused && is_wrong(verdict, truth.verdict);
      }
      if (verdicts[0][i] == verdicts[1][i]) continue;
      const PairPlace place{block.source, block.first + i};
      ++to.differs;
      keep_simplest(to.simplest, place);
      if (wrong[1] && !wrong[0]) {
        ++to.broken;
        keep_simplest(to.simplest_broken, place);
      } else if (wrong[0] && !wrong[1]) {
        ++to.mended;
        keep_simplest(to.simplest_mended, place);
      }
    }
  };
  const auto add = [&](std::vector<VerdictsApart>& all, const std::vector<VerdictsApart>& some) {
    for (std::size_t s = 0; s < all.size(); ++s) {
      all[s] += some[s];
      for (const auto simplest :
           {&VerdictsApart::simplest, &VerdictsApart::simplest_broken, &VerdictsApart::simplest_mended})
        if (some[s].*simplest) keep_simplest(all[s].*simplest, *(some[s].*simplest));
    }
  };
  return sum_over_threads(
      blocks.size(), threads, [&] { return std::vector<VerdictsApart>(sources.size()); }, count_block, add);
}

}  // namespace graze::analysis
