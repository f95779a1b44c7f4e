// SPDX-License-Identifier: Apache-2.0
#include "analysis/discrepancy_origins.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

#include "analysis/sweep.h"
#include "core/discrepancy/count.h"

namespace graze::analysis {
namespace {

constexpr std::uint64_t kPairsTraced = 64;  // pairs

std::vector<FusedLine> lines_of(const Lane& lane) {
  const std::span<const cuda::ContractionSite> sites = cuda::record_sites(lane);
  std::vector<FusedLine> lines;
  for (std::size_t s = 0; s < sites.size(); ++s) {
    const auto known = std::find_if(lines.begin(), lines.end(), [&](const FusedLine& line) {
      return line.at == sites[s].at && line.from == sites[s].from;
    });
    FusedLine& line = known == lines.end() ? lines.emplace_back() : *known;
    line.at = sites[s].at;
    line.from = sites[s].from;
    line.mask.resize((sites.size() + 63) / 64);
    line.mask[s / 64] |= std::uint64_t{1} << s % 64;
  }
  return lines;
}

// The records of a block of pairs with some contractions.
template <class Real>
class FusedRun {
 public:
  FusedRun(const Lane& lane, std::span<const Pair> pairs, std::span<const std::uint64_t> mask)
      : values_(2 * questions_of(lane.algorithm).size() * pairs.size()), paths_(pairs.size()) {
    cuda::record_fusing(lane, pairs, {values_.data(), pairs.size(), paths_.data()}, mask);
  }
  const RecordedPath& path(std::size_t i) const { return paths_[i]; }
  Verdict verdict(std::size_t i) const { return recorded_verdict(paths_[i].path); }
  Real value(std::size_t i, int question, int which) const {
    return values_[static_cast<std::size_t>(2 * question + which) * paths_.size() + i];
  }

 private:
  std::vector<Real> values_;
  std::vector<RecordedPath> paths_;
};

template <class Real>
class Examination {
 public:
  Examination(const Lane& lane, std::span<const Pair> pairs,
              const std::function<bool(const Pair&, const Pair&)>& simpler, Origins& to)
      : lane_(lane), pairs_(pairs), simpler_(simpler), to_(to) {}

  void run() {
    const std::vector<std::uint64_t> none(to_.lines[0].mask.size()), all(none.size(), ~std::uint64_t{0});
    const FusedRun<Real> rounded(lane_, pairs_, none), fused(lane_, pairs_, all);
    std::vector<FusedRun<Real>> alone;
    for (const FusedLine& line : to_.lines) alone.emplace_back(lane_, pairs_, line.mask);
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      if (!is_finite(pairs_[i])) continue;
      ++to_.pairs;
      count_values(i, rounded, fused, alone);
      count_verdicts(i, rounded, fused, alone);
    }
  }

 private:
  // Whether both runs have the value, with the same meaning, and with different bits.
  static bool differs(std::size_t i, const Question& question, int q, int which, const FusedRun<Real>& l,
                      const FusedRun<Real>& r) {
    if (!have_both(l.path(i), r.path(i), q, question.site)) return false;
    return !same_bits(l.value(i, q, which), r.value(i, q, which));
  }

  void count_values(std::size_t i, const FusedRun<Real>& rounded, const FusedRun<Real>& fused,
                    const std::vector<FusedRun<Real>>& alone) {
    const std::vector<Question>& questions = questions_of(lane_.algorithm);
    for (int q = 0; q < static_cast<int>(questions.size()); ++q) {
      const Question& question = questions[static_cast<std::size_t>(q)];
      for (int which = 0; which < static_cast<int>(question.of.size()); ++which) {
        std::size_t first = to_.lines.size();
        for (std::size_t l = to_.lines.size(); l-- > 0;) {
          if (!differs(i, question, q, which, rounded, alone[l])) continue;
          ++to_.lines[l].values;
          first = l;
        }
        if (!differs(i, question, q, which, rounded, fused)) continue;
        Start& start = to_.starts[{q, which}];
        start.by_line.resize(to_.lines.size() + 1);
        ++start.by_line[first];
        if (first == to_.lines.size()) continue;
        const Real before = rounded.value(i, q, which), after = alone[first].value(i, q, which);
        if (!is_finite_value(before) || !is_finite_value(after)) continue;
        const std::uint64_t ulps = apart(before, after);
        ++start.growth[ulps == 0 ? 0 : static_cast<std::size_t>(std::bit_width(ulps) - 1)];
      }
    }
  }

  void count_verdicts(std::size_t i, const FusedRun<Real>& rounded, const FusedRun<Real>& fused,
                      const std::vector<FusedRun<Real>>& alone) {
    const Verdict without = rounded.verdict(i);
    const bool changed = fused.verdict(i) != without;
    to_.verdicts += changed;
    for (std::size_t l = 0; l < to_.lines.size(); ++l) {
      FusedLine& line = to_.lines[l];
      bool decides = alone[l].verdict(i) != without;
      line.verdicts_alone += decides;
      if (changed) {
        std::vector<std::uint64_t> others(line.mask.size());
        for (std::size_t w = 0; w < others.size(); ++w) others[w] = ~line.mask[w];
        const bool fixed = FusedRun<Real>(lane_, pairs_.subspan(i, 1), others).verdict(0) == without;
        line.verdicts_fixed += fixed;
        decides = decides || fixed;
      }
      if (decides && (!line.simplest || simpler_(pairs_[i], *line.simplest))) line.simplest = pairs_[i];
    }
  }

  const Lane& lane_;
  std::span<const Pair> pairs_;
  const std::function<bool(const Pair&, const Pair&)>& simpler_;
  Origins& to_;
};

void add(Origins& to, const Origins& some, const std::function<bool(const Pair&, const Pair&)>& simpler) {
  to.pairs += some.pairs;
  to.verdicts += some.verdicts;
  for (std::size_t l = 0; l < to.lines.size(); ++l) {
    FusedLine& line = to.lines[l];
    line.values += some.lines[l].values;
    line.verdicts_alone += some.lines[l].verdicts_alone;
    line.verdicts_fixed += some.lines[l].verdicts_fixed;
    const std::optional<Pair>& other = some.lines[l].simplest;
    if (other && (!line.simplest || simpler(*other, *line.simplest))) line.simplest = other;
  }
  for (const auto& [place, start] : some.starts) {
    Start& sum = to.starts[place];
    sum.by_line.resize(to.lines.size() + 1);
    for (std::size_t l = 0; l < start.by_line.size(); ++l) sum.by_line[l] += start.by_line[l];
    for (std::size_t k = 0; k < start.growth.size(); ++k) sum.growth[k] += start.growth[k];
  }
}

}  // namespace

bool has_origins(const Lane& lane) { return !cuda::record_sites(lane).empty(); }

Origins origins(const Lane& lane, const std::vector<strata::PairSource>& sources, std::uint64_t pairs, int threads,
                const std::function<bool(const Pair&, const Pair&)>& simpler) {
  std::vector<strata::PairSource> first = sources;
  for (strata::PairSource& source : first) source.pairs = std::min(source.pairs, pairs);
  const std::vector<SourceBlock> blocks = blocks_of(first, kPairsTraced);
  const auto most = static_cast<std::size_t>(threads > 0 ? threads : tbb::info::default_concurrency());
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, most);
  // Equally simple pairs are ordered by their bits, so that the simplest does not depend on the threads.
  const std::function<bool(const Pair&, const Pair&)> before = [&](const Pair& l, const Pair& r) {
    if (simpler(l, r) != simpler(r, l)) return simpler(l, r);
    return std::lexicographical_compare(coordinates(l), coordinates(l) + kCoordinates, coordinates(r),
                                        coordinates(r) + kCoordinates);
  };
  const auto nothing_yet = [&] {
    Origins nothing;
    nothing.lines = lines_of(lane);
    return nothing;
  };
  tbb::enumerable_thread_specific<Origins> results(nothing_yet);
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
    std::vector<Pair> block;
    const strata::PairSource& source = first[static_cast<std::size_t>(blocks[b].source)];
    for (std::uint64_t i = 0; i < blocks[b].count; ++i) block.push_back(source.pair(blocks[b].first + i));
    if (lane.scalar == Scalar::f32) {
      Examination<float>(lane, block, before, results.local()).run();
    } else {
      Examination<double>(lane, block, before, results.local()).run();
    }
  });
  Origins all = nothing_yet();
  for (const Origins& some : results) add(all, some, before);
  return all;
}

}  // namespace graze::analysis
