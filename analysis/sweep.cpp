// SPDX-License-Identifier: Apache-2.0
#include "analysis/sweep.h"

#include <algorithm>
#include <bit>
#include <iterator>

#include "analysis/convention.h"
#include "analysis/over_threads.h"
#include "backends/backends.h"
#include "core/exact/exact.h"
#include "core/judged_bits.h"
#include "core/lanes/ladder.h"
#include "core/relation_of.h"
#include "cuda/engine/sweep.h"

namespace graze::analysis {
namespace {

constexpr std::size_t kBlock = 1024;  // pairs that are drawn and judged together

// Verdicts on a block of pairs: a row of words for each policy.
struct Rows {
  std::size_t words;
  std::vector<std::uint64_t> intersects, declined;
  std::vector<std::uint64_t> excused;  // pairs on which a user's code differs by its convention
  std::vector<Counts> foreign;         // counts of these pairs, and of those on which the code failed
  std::vector<bool> is_foreign;

  Rows(std::size_t rows, std::size_t pairs)
      : words((pairs + 63) / 64),
        intersects(rows * words),
        declined(rows * words),
        excused(rows * words),
        foreign(rows),
        is_foreign(rows) {}
  std::uint64_t yes(std::size_t row, std::size_t word) const { return intersects[row * words + word]; }
  std::uint64_t none(std::size_t row, std::size_t word) const { return declined[row * words + word]; }

  JudgedBits<std::uint64_t> judged(std::size_t row, std::size_t word, const Rows& truth) const {
    // A pair that is not finite is not counted.
    const std::uint64_t count = ~truth.none(0, word) & ~excused[row * words + word];
    return judge(yes(row, word), none(row, word), truth.yes(0, word), count, is_foreign[row]);
  }

  // Classifies the pairs on which a user's code is not right. in_doubles: whether it decided the pairs as doubles.
  void look_at_foreign(std::size_t row, const LaneDecider& decider, const Rows& truth, const strata::PairBlock& pairs,
                       bool in_doubles) {
    is_foreign[row] = true;
    for (std::size_t w = 0; w < words; ++w) {
      for (std::uint64_t bits = judged(row, w, truth).not_right(); bits != 0; bits &= bits - 1) {
        const std::uint64_t bit = bits & ~(bits - 1);
        const bool yes_bit = yes(row, w) & bit, none_bit = none(row, w) & bit;
        const std::size_t i = w * 64 + static_cast<std::size_t>(std::countr_zero(bits));
        const Verdict verdict = in_doubles ? decider.block.verdict_of(yes_bit, none_bit, pairs.doubles[i])
                                           : decider.block.verdict_of(yes_bit, none_bit, pairs.floats[i]);
        const auto is_by_convention = [&](const auto& pair) {
          return by_convention(*decider.foreign, verdict, pair, relation_of(pair));
        };
        if (is_failure(verdict)) {
          ++foreign[row].of(verdict);
        } else if (decider.foreign->outside != 0 && visit(pairs[i], is_by_convention)) {
          excused[row * words + w] |= bit;
          ++foreign[row].by_convention;
        }
      }
    }
  }
};

void keep_first(std::optional<PairPlace>& kept, const std::optional<PairPlace>& found) {
  if (found && (!kept || *found < *kept)) kept = found;
}

// Adds the number of set bits to `count`, and keeps the place of the first one.
void add(std::uint64_t bits, const PairPlace& word, std::uint64_t& count, std::optional<PairPlace>& first) {
  if (bits == 0) return;
  count += static_cast<std::uint64_t>(std::popcount(bits));
  keep_first(first, PairPlace{word.source, word.index + static_cast<std::uint64_t>(std::countr_zero(bits))});
}

void add(const JudgedBits<std::uint64_t>& bits, Counts& counts) {
  counts.false_positive += static_cast<std::uint64_t>(std::popcount(bits.false_positive));
  counts.false_negative += static_cast<std::uint64_t>(std::popcount(bits.false_negative));
  counts.declined += static_cast<std::uint64_t>(std::popcount(bits.declined));
}

// Adds the errors of row `p`; row 0 belongs to the lane without a policy.
void add(const SourceBlock& block, const Rows& truth, const Rows& lane, std::size_t p, PolicyErrors& errors) {
  for (std::size_t w = 0; w < truth.words; ++w) {
    const JudgedBits now = lane.judged(p, w, truth), before = lane.judged(0, w, truth);
    add(now, errors);
    const PairPlace word{block.source, block.first + w * 64};
    add(before.not_right() & ~now.not_right(), word, errors.fixed, errors.first_fixed);
    add(now.not_right() & ~before.not_right(), word, errors.broken, errors.first_broken);
  }
  errors.Counts::operator+=(lane.foreign[p]);
  errors.pairs += block.count;
}

void add(const SourceBlock& block, const Rows& truth, const Rows& first, const Rows& second, std::size_t p,
         Agreement& agreement) {
  const auto differing = [&](std::size_t row, std::size_t w) {
    return (first.yes(row, w) ^ second.yes(row, w)) | (first.none(row, w) ^ second.none(row, w));
  };
  const auto count = [](std::uint64_t bits) { return static_cast<std::uint64_t>(std::popcount(bits)); };
  for (std::size_t w = 0; w < truth.words; ++w) {
    agreement.intersecting += count(truth.yes(0, w));
    add(first.judged(p, w, truth), agreement.of[0]);
    add(second.judged(p, w, truth), agreement.of[1]);
    const std::uint64_t now = differing(p, w), before = differing(0, w);
    add(now, {block.source, block.first + w * 64}, agreement.differing, agreement.first);
    agreement.mended += count(before & ~now);
    agreement.added += count(now & ~before);
  }
  agreement.pairs += block.count;
}

void keep_first(std::vector<NotRightPair>& pairs) {
  const auto by_place = [](const NotRightPair& l, const NotRightPair& r) { return l.place < r.place; };
  std::sort(pairs.begin(), pairs.end(), by_place);
  if (pairs.size() > NotRightPairs::kMostListed) pairs.resize(NotRightPairs::kMostListed);
}

void add(const SourceBlock& block, const Rows& truth, const Rows& lane, NotRightPairs& found) {
  const std::size_t policies = lane.intersects.size() / lane.words;
  for (std::size_t w = 0; w < truth.words; ++w) {
    std::uint64_t wrong = 0;
    for (std::size_t p = 0; p < policies; ++p) wrong |= lane.judged(p, w, truth).not_right();
    found.count += static_cast<std::uint64_t>(std::popcount(wrong));
    for (; wrong != 0; wrong &= wrong - 1) {
      const auto bit = static_cast<std::uint64_t>(std::countr_zero(wrong));
      const auto is_set = [&](std::uint64_t word) { return (word >> bit & 1) != 0; };
      found.first.push_back({{block.source, block.first + w * 64 + bit}, is_set(truth.yes(0, w)), {}});
      for (std::size_t p = 0; p < policies; ++p)
        found.first.back().verdicts.push_back(verdict_of_bits(is_set(lane.yes(p, w)), is_set(lane.none(p, w))));
    }
  }
  if (found.first.size() > 2 * NotRightPairs::kMostListed) keep_first(found.first);
}

// Policies that are adjacent in the list of policies and are decided together.
struct Together {
  std::size_t first;
  LaneDecider one;  // for a single policy
  Ladders ladders;  // for several policies
  std::vector<Epsilons> rungs;

  // A lane that takes only float32 decides pairs of doubles as float32 stores them.
  void decide(const strata::PairBlock& pairs, const Rows& truth, Rows& rows) const {
    const bool in_doubles = pairs.in_doubles() && (ladders ? bool(ladders.doubles) : one.block.decides_doubles());
    std::uint64_t* const intersects = &rows.intersects[first * rows.words];
    std::uint64_t* const declined = &rows.declined[first * rows.words];
    const auto run = [&](const auto& of, const auto& ladder) {
      if (ladders) return ladder(rungs, of.data(), of.size(), intersects, declined);
      one.block(of.data(), of.size(), intersects, declined);
    };
    in_doubles ? run(pairs.doubles, ladders.doubles) : run(pairs.floats, ladders.floats);
    if (!ladders && one.foreign) rows.look_at_foreign(first, one, truth, pairs, in_doubles);
  }
};

// Draws the pairs in blocks, computes each pair's truth once, and runs every lane on the pairs under every policy. Then
// calls add(block, truth, rows, p, results[p]) with the rows of all lanes for each result.
template <class Result, class Add>
std::vector<Result> run(const std::vector<std::vector<Together>>& lanes, std::size_t policies,
                        const std::vector<Result>& empty, Sources sources, int threads, const Add& add) {
  const DecideBlock exact = find_lane("exact/f32/cpu")->decide, in_doubles = find_lane("exact/f64/cpu")->decide;
  const std::vector<SourceBlock> blocks = blocks_of(sources, kBlock);
  const auto run_block = [&](std::size_t b, std::vector<Result>& result) {
    const SourceBlock& block = blocks[b];
    const strata::PairBlock pairs =
        strata::pairs_of(sources[static_cast<std::size_t>(block.source)], block.first, block.count);
    Rows truth(1, pairs.size());
    if (pairs.in_doubles()) {
      in_doubles(pairs.doubles.data(), pairs.size(), truth.intersects.data(), truth.declined.data());
    } else {
      exact(pairs.floats.data(), pairs.size(), truth.intersects.data(), truth.declined.data());
    }
    std::vector<Rows> rows(lanes.size(), Rows(policies, pairs.size()));
    for (std::size_t l = 0; l < lanes.size(); ++l) {
      for (const Together& part : lanes[l]) part.decide(pairs, truth, rows[l]);
    }
    for (std::size_t p = 0; p < result.size(); ++p) add(block, truth, rows, p, result[p]);
  };
  return sum_over_threads(
      blocks.size(), threads, [&] { return empty; }, run_block,
      [](std::vector<Result>& sums, const std::vector<Result>& some) {
        for (std::size_t p = 0; p < some.size(); ++p) sums[p] += some[p];
      });
}

template <class Result>
std::vector<Result> without_counts(Policies policies) {
  std::vector<Result> results;
  for (const std::string& policy : policies) results.emplace_back().policy = policy;
  return results;
}

// Returns the empty policy, followed by these policies.
std::vector<std::string> with_zero(Policies policies) {
  std::vector<std::string> all = {""};
  all.insert(all.end(), policies.begin(), policies.end());
  return all;
}

std::vector<PolicyErrors> errors_of(const std::vector<Together>& parts, Policies policies, Sources sources,
                                    int threads) {
  return run({parts}, policies.size() + 1, without_counts<PolicyErrors>(policies), sources, threads,
             [](const SourceBlock& block, const Rows& truth, const std::vector<Rows>& rows, std::size_t p,
                PolicyErrors& errors) { add(block, truth, rows[0], p + 1, errors); });
}

// Whether the second policy may follow the first on a ladder: none of its tolerances is smaller.
bool rises(const Epsilons& first, const Epsilons& second) {
  for (int s = 0; s < kSiteCount; ++s) {
    if (!(first.absolute[s] <= second.absolute[s] && first.relative[s] <= second.relative[s])) return false;
  }
  return first.any_relative() == second.any_relative();
}

// Divides the policies into as few ladders as their order allows. (A sweep lists a curve's tolerances one after
// another.)
std::vector<Together> parts_of(const Lane& lane, Policies policies) {
  std::vector<Together> parts;
  for (std::size_t p = 0; p < policies.size(); ++p) {
    const Lane under = policies[p].empty() ? lane : lane_under(lane, policies[p]);
    const bool tolerances = under.under && under.under->kind == Policy::Kind::tolerances;
    const Ladders ladders = tolerances ? ladders_of(lane, under.under->epsilons.any_relative()) : Ladders();
    if (!ladders) {
      parts.push_back({p, backends::on_host(under), {}, {}});
    } else if (!parts.empty() && parts.back().ladders && rises(parts.back().rungs.back(), under.under->epsilons)) {
      parts.back().rungs.push_back(under.under->epsilons);
    } else {
      parts.push_back({p, DecideBlock(), ladders, {under.under->epsilons}});
    }
  }
  return parts;
}

std::vector<Together> parts_of(const DecideUnder& decide, Policies policies) {
  std::vector<Together> parts;
  for (const std::string& policy : policies) parts.push_back({parts.size(), decide(policy), {}, {}});
  return parts;
}

NotRightPairs not_right_in(const std::vector<Together>& parts, Policies policies, Sources sources, int threads) {
  return run({parts}, policies.size(), std::vector<NotRightPairs>(1), sources, threads,
             [](const SourceBlock& block, const Rows& truth, const std::vector<Rows>& rows, std::size_t,
                NotRightPairs& found) { add(block, truth, rows[0], found); })
      .front();
}

}  // namespace

std::vector<SourceBlock> blocks_of(Sources sources, std::uint64_t most) {
  std::vector<SourceBlock> blocks;
  for (std::size_t s = 0; s < sources.size(); ++s) {
    for (std::uint64_t first = 0; first < sources[s].pairs; first += most)
      blocks.push_back({static_cast<int>(s), first, std::min(most, sources[s].pairs - first)});
  }
  return blocks;
}

bool any_in_doubles(Sources sources) {
  return std::any_of(sources.begin(), sources.end(),
                     [](const strata::PairSource& source) { return source.in_doubles(); });
}

std::uint64_t pairs_in(Sources sources) {
  std::uint64_t pairs = 0;
  for (const strata::PairSource& source : sources) pairs += source.pairs;
  return pairs;
}

PolicyErrors& PolicyErrors::operator+=(const PolicyErrors& other) {
  Counts::operator+=(other);
  pairs += other.pairs;
  fixed += other.fixed;
  broken += other.broken;
  keep_first(first_fixed, other.first_fixed);
  keep_first(first_broken, other.first_broken);
  return *this;
}

Agreement& Agreement::operator+=(const Agreement& other) {
  pairs += other.pairs;
  intersecting += other.intersecting;
  differing += other.differing;
  mended += other.mended;
  added += other.added;
  for (int l = 0; l < 2; ++l) of[l] += other.of[l];
  keep_first(first, other.first);
  return *this;
}

NotRightPairs& NotRightPairs::operator+=(NotRightPairs other) {
  count += other.count;
  first.insert(first.end(), std::make_move_iterator(other.first.begin()), std::make_move_iterator(other.first.end()));
  keep_first(first);
  return *this;
}

Sweep host_sweep(DecideUnder decide, int threads) {
  return [decide = std::move(decide), threads](Policies policies, Sources sources) {
    return errors_of(parts_of(decide, with_zero(policies)), policies, sources, threads);
  };
}

Sweep host_sweep(const Lane& lane, int threads) {
  return [&lane, threads](Policies policies, Sources sources) {
    return errors_of(parts_of(lane, with_zero(policies)), policies, sources, threads);
  };
}

NotRightPairs not_right_pairs(const Lane& lane, Policies policies, Sources sources, int threads) {
  return not_right_in(parts_of(lane, policies), policies, sources, threads);
}

NotRightPairs not_right_pairs(const DecideUnder& decide, Policies policies, Sources sources, int threads) {
  return not_right_in(parts_of(decide, policies), policies, sources, threads);
}

AgreementSweep agreement_sweep(const Lane& first, const Lane& second, int threads) {
  return [&first, &second, threads](Policies policies, Sources sources) {
    const std::vector<std::string> all = with_zero(policies);
    return run({parts_of(first, all), parts_of(second, all)}, all.size(), without_counts<Agreement>(policies), sources,
               threads,
               [](const SourceBlock& block, const Rows& truth, const std::vector<Rows>& rows, std::size_t p,
                  Agreement& agreement) { add(block, truth, rows[0], rows[1], p + 1, agreement); });
  };
}

Sweep device_sweep(std::function<Lane(const std::string& policy)> lane_of) {
  return [lane_of = std::move(lane_of)](Policies policies, Sources sources) {
    std::vector<PolicyErrors> errors;
    std::vector<Lane> lanes;
    for (const std::string& policy : policies) {
      errors.emplace_back().policy = policy;
      lanes.push_back(lane_of(policy));
    }
    const Lane zero = lane_of("");
    for (std::size_t s = 0; s < sources.size(); ++s) {
      const std::vector<cuda::ErrorCounts> found = cuda::count_errors(zero, lanes, sources[s]);
      for (std::size_t p = 0; p < found.size(); ++p) {
        const auto place = [s](std::uint64_t index) {
          return index == ~std::uint64_t{0} ? std::nullopt : std::optional<PairPlace>({static_cast<int>(s), index});
        };
        errors[p] += {found[p],
                      policies[p],
                      sources[s].pairs,
                      found[p].fixed,
                      found[p].broken,
                      place(found[p].first_fixed),
                      place(found[p].first_broken)};
      }
    }
    return errors;
  };
}

}  // namespace graze::analysis
