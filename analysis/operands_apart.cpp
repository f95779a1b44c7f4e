// SPDX-License-Identifier: Apache-2.0
#include "analysis/operands_apart.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <type_traits>

#include "analysis/apart.h"
#include "analysis/discrepancy.h"
#include "core/discrepancy/count.h"

namespace graze::analysis {
namespace {

constexpr std::size_t kMostComparisons = 1 << 14;  // per run; later comparisons are not counted

// Counts are passed between processes as raw memory.
static_assert(std::is_trivially_copyable_v<LineApart>);

struct Run {
  std::vector<cuda::Comparison> made = std::vector<cuda::Comparison>(kMostComparisons);
  std::size_t count = 0;
  Verdict verdict = Verdict::declined;
};

class OperandCounts {
 public:
  explicit OperandCounts(const Lane& fused)
      : fused_(fused), all_(1 + cuda::contraction_sites(fused).size() / 64, ~std::uint64_t{0}), none_(all_.size()) {
    for (const cuda::ComparisonSite& site : cuda::comparison_sites(fused)) {
      auto line = std::find_if(result_.lines.begin(), result_.lines.end(),
                               [&](const LineApart& of) { return of.at == site.at && of.from == site.from; });
      if (line == result_.lines.end()) line = result_.lines.insert(line, {site.at, site.from});
      by_ptx_line_[site.ptx_line] = static_cast<std::size_t>(line - result_.lines.begin());
    }
  }

  void count(const AnyPair& pair) {
    run(pair, none_, rounded_run_);
    run(pair, all_, fused_run_);
    const bool differs = rounded_run_.verdict != fused_run_.verdict;
    ++result_.pairs;
    result_.verdict += differs;
    for (std::size_t i = 0; i < std::min(rounded_run_.count, fused_run_.count); ++i) {
      const cuda::Comparison &l = rounded_run_.made[i], &r = fused_run_.made[i];
      if (l.ptx_line != r.ptx_line) return;  // the runs diverged at a test that does not compare numbers
      LineApart& line = result_.lines[by_ptx_line_.at(l.ptx_line)];
      count_operands(line, l, r);
      if (l.outcome == r.outcome) continue;
      ++line.outcome;
      line.verdict += differs;
      return;
    }
  }

  const OperandsApart& result() const { return result_; }

 private:
  void run(const AnyPair& pair, const std::vector<std::uint64_t>& fused, Run& to) const {
    to.verdict = cuda::decide_comparing(fused_, pair, fused, to.made, to.count);
  }

  void count_operands(LineApart& line, const cuda::Comparison& l, const cuda::Comparison& r) const {
    ++line.compared;
    if (same_bits(l.left, r.left) && same_bits(l.right, r.right)) return;
    ++line.differs;
    line.sign += order_of(l.left, l.right) != order_of(r.left, r.right);
    if (!is_finite_value(l.left) || !is_finite_value(l.right) || !is_finite_value(r.left) ||
        !is_finite_value(r.right)) {
      ++line.not_finite;
      return;
    }
    const std::uint64_t left = ulps_apart(fused_.scalar, l.left, r.left),
                        right = ulps_apart(fused_.scalar, l.right, r.right);
    if (left == 0 && right == 0) {
      ++line.zero_sign;
      return;
    }
    const bool lower = left >= right ? r.left < l.left : r.right < l.right;
    ++(lower ? line.below : line.above)[static_cast<std::size_t>(std::bit_width(std::max(left, right)) - 1)];
  }

  const Lane& fused_;
  std::vector<std::uint64_t> all_, none_;
  std::map<int, std::size_t> by_ptx_line_;
  OperandsApart result_;
  Run rounded_run_, fused_run_;
};

}  // namespace

bool shows_operands(const Lane& rounded, const Lane& fused) {
  return rounded.foreign && fused.foreign && rounded.info == fused.info && rounded.scalar == fused.scalar &&
         rounded.variant == Variant::cuda_nofma && fused.variant == Variant::cuda_fma &&
         !cuda::contraction_sites(fused).empty() && !cuda::comparison_sites(fused).empty();
}

OperandsApart operands_apart(const Lane& fused, const std::vector<strata::PairSource>& sources, std::uint64_t pairs) {
  OperandCounts counts(fused);
  std::string bytes;
  const Ended ended = run_apart(
      fused, cuda::most_seconds(fused),
      [&](const ApartFrom& apart) {
        for (const strata::PairSource& source : sources) {
          for (std::uint64_t i = 0; i < std::min(pairs, source.pairs); ++i) {
            const AnyPair pair = source.any_pair(i);
            apart.alive();
            if (is_finite(pair.doubles)) counts.count(pair);
          }
        }
        const OperandsApart& found = counts.result();
        std::string result;
        for (const std::uint64_t number : {found.pairs, found.verdict})
          result.append(reinterpret_cast<const char*>(&number), sizeof number);
        result.append(reinterpret_cast<const char*>(found.lines.data()), found.lines.size() * sizeof(LineApart));
        apart.finish(result.data(), result.size());
      },
      bytes);
  OperandsApart found = counts.result();
  if (ended != Ended::in_order) {
    found.why_not = ended == Ended::silent ? "with some of its products fused, or with none, the code does not return"
                                           : "with some of its products fused, or with none, the code crashes";
    return found;
  }
  std::memcpy(&found.pairs, bytes.data(), sizeof found.pairs);
  std::memcpy(&found.verdict, bytes.data() + sizeof found.pairs, sizeof found.verdict);
  std::memcpy(found.lines.data(), bytes.data() + 2 * sizeof found.pairs, found.lines.size() * sizeof(LineApart));
  return found;
}

}  // namespace graze::analysis
