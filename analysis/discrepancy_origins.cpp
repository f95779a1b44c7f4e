// SPDX-License-Identifier: Apache-2.0
#include "analysis/discrepancy_origins.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <type_traits>

#include "analysis/over_threads.h"
#include "analysis/sweep.h"
#include "core/discrepancy/count.h"

namespace graze::analysis {
namespace {

constexpr std::uint64_t kPairsTraced = 64;  // pairs in a block

using Mask = std::vector<std::uint64_t> FusedLine::*;

using Sites = std::span<const cuda::ContractionSite>;

std::size_t words_of(Sites sites) { return (sites.size() + 63) / 64; }

void add_lines(Sites sites, Mask mask, std::vector<FusedLine>& lines) {
  for (std::size_t s = 0; s < sites.size(); ++s) {
    const auto known = std::find_if(lines.begin(), lines.end(), [&](const FusedLine& line) {
      return line.at == sites[s].at && line.from == sites[s].from;
    });
    FusedLine& line = known == lines.end() ? lines.emplace_back() : *known;
    line.at = sites[s].at;
    line.from = sites[s].from;
    (line.*mask).resize(words_of(sites));
    (line.*mask)[s / 64] |= std::uint64_t{1} << s % 64;
  }
}

// The fused lines of the kernels for the sources' coordinate types.
std::vector<FusedLine> lines_of(const Lane& lane, Sources sources) {
  const cuda::TwinRow& row = cuda::record_row(lane);
  const Sites of_floats = row.sites, of_doubles = row.doubles.sites;
  std::vector<FusedLine> lines;
  if (!std::all_of(sources.begin(), sources.end(), std::mem_fn(&strata::PairSource::in_doubles)))
    add_lines(of_floats, &FusedLine::mask, lines);
  if (any_in_doubles(sources)) add_lines(of_doubles, &FusedLine::mask_of_doubles, lines);
  for (FusedLine& line : lines) {  // a line may have no site in one of the two kernels
    line.mask.resize(words_of(of_floats));
    line.mask_of_doubles.resize(words_of(of_doubles));
  }
  return lines;
}

// The lane's values on a block of pairs, recorded with only some products fused.
template <class Real>
class FusedRun {
 public:
  template <class Coordinate>
  FusedRun(const Lane& lane, std::span<const BasicPair<Coordinate>> pairs, std::span<const std::uint64_t> mask)
      : values_(2 * questions_of(lane.algorithm).size() * pairs.size()), paths_(pairs.size()) {
    const cuda::TwinRow& row = cuda::record_row(lane);
    const Records to{values_.data(), pairs.size(), paths_.data()};
    if constexpr (std::is_same_v<Coordinate, float>) {
      row.record_fusing(pairs.data(), pairs.size(), to, mask.data());
    } else {
      row.doubles.record_fusing(pairs.data(), pairs.size(), to, mask.data());
    }
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

template <class Real, class Coordinate>
class Examination {
 public:
  Examination(const Lane& lane, std::span<const BasicPair<Coordinate>> pairs, const Simpler& simpler, Origins& to)
      : lane_(lane), pairs_(pairs), simpler_(simpler), to_(to) {}

  void run() {
    const std::vector<std::uint64_t> none((to_.lines[0].*kMask).size()), all(none.size(), ~std::uint64_t{0});
    const FusedRun<Real> rounded(lane_, pairs_, none), fused(lane_, pairs_, all);
    std::vector<FusedRun<Real>> alone;
    for (const FusedLine& line : to_.lines) alone.emplace_back(lane_, pairs_, line.*kMask);
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      if (!is_finite(pairs_[i])) continue;
      ++to_.pairs;
      count_values(i, rounded, fused, alone);
      count_verdicts(i, rounded, fused, alone);
    }
  }

 private:
  static constexpr Mask kMask = std::is_same_v<Coordinate, float> ? &FusedLine::mask : &FusedLine::mask_of_doubles;

  // Whether both runs computed this value, with the same meaning and different bits.
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
        std::vector<std::uint64_t> others(line.*kMask);
        for (std::uint64_t& word : others) word = ~word;
        const bool fixed = FusedRun<Real>(lane_, pairs_.subspan(i, 1), others).verdict(0) == without;
        line.verdicts_fixed += fixed;
        decides = decides || fixed;
      }
      if (decides && (!line.simplest || simpler_(pairs_[i], *line.simplest))) line.simplest = pairs_[i];
    }
  }

  const Lane& lane_;
  std::span<const BasicPair<Coordinate>> pairs_;
  const Simpler& simpler_;
  Origins& to_;
};

template <class Real, class Coordinate>
void examine(const Lane& lane, const std::vector<BasicPair<Coordinate>>& pairs, const Simpler& simpler, Origins& to) {
  Examination<Real, Coordinate>(lane, pairs, simpler, to).run();
}

void add(Origins& to, const Origins& some, const Simpler& simpler) {
  to.pairs += some.pairs;
  to.verdicts += some.verdicts;
  for (std::size_t l = 0; l < to.lines.size(); ++l) {
    FusedLine& line = to.lines[l];
    line.values += some.lines[l].values;
    line.verdicts_alone += some.lines[l].verdicts_alone;
    line.verdicts_fixed += some.lines[l].verdicts_fixed;
    const std::optional<AnyPair>& other = some.lines[l].simplest;
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

bool has_origins(const Lane& lane) { return !cuda::record_row(lane).sites.empty(); }

Origins origins(const Lane& lane, const std::vector<strata::PairSource>& sources, std::uint64_t pairs, int threads,
                const Simpler& simpler) {
  std::vector<strata::PairSource> first = sources;
  for (strata::PairSource& source : first) source.pairs = std::min(source.pairs, pairs);
  const std::vector<SourceBlock> blocks = blocks_of(first, kPairsTraced);
  // Orders equally simple pairs by coordinates and type, so that the result does not depend on the threads.
  const Simpler before = [&](const AnyPair& l, const AnyPair& r) {
    if (simpler(l, r) != simpler(r, l)) return simpler(l, r);
    const double *of_l = coordinates(l.doubles), *of_r = coordinates(r.doubles);
    const auto [differs, other] = std::mismatch(of_l, of_l + kCoordinates, of_r);
    return differs == of_l + kCoordinates ? l.floats && !r.floats : *differs < *other;
  };
  const auto nothing_yet = [&] {
    Origins nothing;
    nothing.lines = lines_of(lane, first);
    return nothing;
  };
  const auto examine_block = [&](std::size_t b, Origins& to) {
    const strata::PairSource& source = first[static_cast<std::size_t>(blocks[b].source)];
    const strata::PairBlock block = strata::pairs_of(source, blocks[b].first, blocks[b].count);
    if (block.in_doubles()) {
      examine<double>(lane, block.doubles, before, to);
    } else if (lane.scalar == Scalar::f32) {
      examine<float>(lane, block.floats, before, to);
    } else {
      examine<double>(lane, block.floats, before, to);
    }
  };
  return sum_over_threads(blocks.size(), threads, nothing_yet, examine_block,
                          [&](Origins& all, const Origins& some) { add(all, some, before); });
}

}  // namespace graze::analysis
