// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/cpu_engine.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "analysis/convention.h"
#include "analysis/signature.h"
#include "core/margin/stored_margin.h"
#include "core/margin_blocks/buckets.h"
#include "core/relation_of.h"
#include "fuzz/campaign/signature_counts.h"
#include "oracle/truth.h"

namespace graze::fuzz {
namespace {

constexpr std::size_t kBlockPairs = 1024;   // pairs per task, or fewer if there are few pairs; a multiple of 64
constexpr std::uint64_t kGmpSample = 1024;  // GMP confirms every disagreement, and one pair in 1024
constexpr std::uint64_t kSample = 1000;     // when the exact lane judges, CGAL and GMP decide one pair in 1000

constexpr std::size_t kSidePatterns = 729;

// Encodes on which side of each triangle's plane the other's vertices seem to lie, as a number below kSidePatterns.
std::size_t side_pattern(const Pair& pair) {
  const Vec3<float> normal_a = cross(pair.a[1] - pair.a[0], pair.a[2] - pair.a[0]);
  const Vec3<float> normal_b = cross(pair.b[1] - pair.b[0], pair.b[2] - pair.b[0]);
  std::size_t pattern = 0;
  const auto add = [&](float distance) { pattern = 3 * pattern + (distance > 0 ? 2 : distance < 0 ? 1 : 0); };
  for (const Vec3<float>& v : pair.b) add(dot(normal_a, v - pair.a[0]));
  for (const Vec3<float>& v : pair.a) add(dot(normal_b, v - pair.b[0]));
  return pattern;
}

// Sorts the indices by their pairs' side patterns, and keeps the order within a pattern. Lanes take the same branches
// on neighbours with the same pattern, so the processor predicts the branches. Counts and kept cases do not depend on
// the order. Returns: the old indices, in the new order.
std::vector<std::uint32_t> bring_together(std::span<const Pair> pairs) {
  std::array<std::uint32_t, kSidePatterns + 1> next{};
  std::vector<std::uint16_t> patterns(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    patterns[i] = static_cast<std::uint16_t>(side_pattern(pairs[i]));
    ++next[patterns[i] + 1u];
  }
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<std::uint32_t> order(pairs.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[next[patterns[i]]++] = i;
  return order;
}

template <class T>
void reorder(std::span<T> values, const std::vector<std::uint32_t>& order) {
  const std::vector<T> before(values.begin(), values.end());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = before[order[i]];
}

// The pairs to judge, rounded to float32, and also as doubles if they are pairs of doubles.
struct PairsToJudge {
  std::span<const Pair> pairs;
  std::span<const DoublePair> doubles = {};

  // Calls with(pair) in the pair's own coordinate type.
  template <class With>
  auto visit(std::size_t i, const With& with) const {
    return doubles.empty() ? with(pairs[i]) : with(doubles[i]);
  }
};

// Judges one block of pairs. Runs host lanes and twins, and computes the truth. Device lanes have already run.
class BlockJudge {
 public:
  // exact: if not null, decides instead of CGAL and GMP.
  BlockJudge(const Campaign& campaign, int source, const DecideBlock& exact,
             const std::vector<VerdictBits>& device_bits)
      : campaign_(campaign),
        under_test_(*campaign.under_test),
        source_(source),
        exact_(exact),
        device_bits_(device_bits),
        decider_(under_test_),
        verdicts_(under_test_.lanes.size()),
        signatures_(under_test_.lanes) {}

  // begin: the position of the first pair in the device lanes' bits.
  void judge(const PairsToJudge& to_judge, std::span<const std::uint64_t> indices, std::size_t begin,
             BatchResult& result, PairJudge::Found* found = nullptr) {
    const std::span<const Pair> pairs = to_judge.pairs;
    find_truth(to_judge, result);
    views_ = decider_.decide(
        pairs, device_bits_, begin,
        [&](std::size_t l, std::size_t i) {
          result.executor_mismatches[under_test_.lanes[l]->id].add(CaseKey{indices[i], source_});
        },
        to_judge.doubles);
    const analysis::JudgedBlock block{pairs.size(), truth_, buckets_, views_, changed_by_storing_};
    result.tally.add(block);
    result.digests.pairs += pairs.size();
    if (const Axis axis = campaign_.sources[static_cast<std::size_t>(source_)].axis; axis != Axis::none) {
      extremes_.resize(pairs.size());
      for (std::size_t i = 0; i < pairs.size(); ++i)
        extremes_[i] = to_judge.visit(i, [&](const auto& pair) { return place_on_axis(pair, axis); });
      result.extremes.add(analysis::JudgedBlock{pairs.size(), truth_, extremes_, views_, changed_by_storing_});
    }
    const analysis::Bits not_right = analysis::not_right(block);
    const std::uint64_t sample = exact_ ? kSample : kGmpSample;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const bool some_not_right = test_bit(not_right, i), sampled = indices[i] % sample == 0;
      if (!some_not_right && !sampled) continue;
      to_judge.visit(i, [&](const auto& pair) {
        const Relation relation = exact_ ? relation_by_exact_lane(pair, indices[i], i, sampled, result)
                                         : relation_by_oracle(pair, indices[i], i, result);
        if (some_not_right) add_failures(pair, CaseKey{indices[i], source_}, i, relation, result, found);
      });
    }
    if (!found) return;
    found->truth = truth(0);
    found->bucket = buckets_[0];
    if (!test_bit(not_right, 0)) verdicts_.assign(views_.size(), found->truth);
    found->verdicts = verdicts_;
  }

  // Adds the signatures counted since the last call.
  void add_signatures(BatchResult& result) { signatures_.move_to(result.signatures); }

 private:
  const std::string& source_id() const { return campaign_.sources[static_cast<std::size_t>(source_)].id; }

  Verdict truth(std::size_t i) const { return test_bit(truth_, i) ? Verdict::intersects : Verdict::disjoint; }

  [[noreturn]] void apart(std::uint64_t index, const std::string& what) const {
    throw oracle::OracleMismatch(fmt::format("{} differ on {}:{}:{}", what, source_id(), campaign_.seed, index));
  }

  void find_truth(const PairsToJudge& to_judge, BatchResult& result) {
    buckets_.resize(to_judge.pairs.size());
    if (to_judge.doubles.empty()) {
      decide_truth(to_judge.pairs, result);
      margin_buckets(coordinates(to_judge.pairs.front()), buckets_.size(), truth_.data(), buckets_.data());
    } else {
      decide_truth(to_judge.doubles, result);
      find_changed_by_storing(to_judge.pairs);
      find_wide_margins(to_judge.pairs);
    }
    for (std::size_t i = 0; i < buckets_.size(); ++i) {
      if (buckets_[i] == kOpenBucket)
        buckets_[i] = to_judge.visit(i, [&](const auto& pair) { return oracle::margin_bucket(pair, truth(i)); });
    }
  }

  template <class AnyPair>
  void decide_truth(std::span<const AnyPair> pairs, BatchResult& result) {
    const std::size_t words = (pairs.size() + 63) / 64;
    truth_.assign(words, 0);
    if (exact_) {
      none_.resize(words);
      exact_(pairs.data(), pairs.size(), truth_.data(), none_.data());
      result.exact += pairs.size();
    } else {
      for (std::size_t i = 0; i < pairs.size(); ++i)
        truth_[i / 64] |= std::uint64_t{oracle::cgal_verdict(pairs[i]) == Verdict::intersects} << (i % 64);
      result.cgal += pairs.size();
    }
  }

  // With the exact lane, finds pairs of doubles whose verdict changes in float32, or that exceed float32's range.
  void find_changed_by_storing(std::span<const Pair> stored) {
    none_.resize(truth_.size());
    changed_by_storing_.resize(truth_.size());
    find_lane(kExactLane)->decide(stored.data(), stored.size(), changed_by_storing_.data(), none_.data());
    for (std::size_t w = 0; w < truth_.size(); ++w)
      changed_by_storing_[w] = (changed_by_storing_[w] ^ truth_[w]) | none_[w];
  }

  // Finds the margin bucket of each pair of doubles whose margin in float32 determines it; the others remain open.
  void find_wide_margins(std::span<const Pair> stored) {
    std::vector<Pair> unchanged;
    std::vector<std::size_t> places;
    analysis::Bits intersects(truth_.size());
    for (std::size_t i = 0; i < stored.size(); ++i) {
      if (test_bit(changed_by_storing_, i)) continue;
      intersects[places.size() / 64] |= std::uint64_t{test_bit(truth_, i)} << places.size() % 64;
      unchanged.push_back(stored[i]);
      places.push_back(i);
    }
    std::vector<Bucket> of_stored(places.size());
    if (!places.empty())
      margin_buckets(coordinates(unchanged.front()), places.size(), intersects.data(), of_stored.data());
    buckets_.assign(stored.size(), kOpenBucket);
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (of_stored[k] != kOpenBucket) buckets_[places[k]] = wide_bucket(of_stored[k], kOpenBucket);
    }
  }

  template <class AnyPair>
  Relation relation_by_oracle(const AnyPair& pair, std::uint64_t index, std::size_t i, BatchResult& result) const {
    const Contact contact = oracle::gmp_contact(pair);
    ++result.gmp;
    if ((contact == Contact::none) != (truth(i) == Verdict::disjoint))
      apart(index, fmt::format("CGAL ({}) and GMP (contact {})", name(truth(i)), name(contact)));
    return {truth(i), contact, sign_of(buckets_[i]), oracle::hulls(pair)};
  }

  template <class AnyPair>
  Relation relation_by_exact_lane(const AnyPair& pair, std::uint64_t index, std::size_t i, bool sampled,
                                  BatchResult& result) const {
    const Relation relation = relation_of(pair);
    if (relation.verdict != truth(i))
      apart(index, fmt::format("the exact lane ({}) and the exact relation (contact {})", name(truth(i)),
                               name(relation.contact)));
    if (!sampled) return relation;
    ++result.cgal;
    if (oracle::cgal_verdict(pair) != truth(i) || relation_by_oracle(pair, index, i, result) != relation)
      apart(index,
            fmt::format("the exact lane ({}, contact {}) and the oracle", name(truth(i)), name(relation.contact)));
    return relation;
  }

  template <class AnyPair>
  void add_failures(const AnyPair& pair, const CaseKey& key, std::size_t i, const Relation& relation,
                    BatchResult& result, PairJudge::Found* found) {
    bool any_wrong = false;
    for (std::size_t l = 0; l < views_.size(); ++l) {
      verdicts_[l] = views_[l].at(i);
      if (verdicts_[l] == truth(i)) continue;
      result.digests.add(l, key.index, verdicts_[l]);
      const bool in_float32 = !changed_by_storing_.empty() && under_test_.lanes[l]->scalar == Scalar::f32;
      const bool stored = in_float32 && test_bit(changed_by_storing_, i) && !is_failure(verdicts_[l]) &&
                          verdicts_[l] != Verdict::declined;
      if (under_test_.lanes[l]->exact && !stored && !(in_float32 && verdicts_[l] == Verdict::declined))
        apart(key.index,
              fmt::format("{} ({}) and the truth ({})", under_test_.lanes[l]->id, name(verdicts_[l]), name(truth(i))));
      if (analysis::by_convention(*under_test_.lanes[l], verdicts_[l], pair, relation)) {
        result.tally.excuse(buckets_[i], static_cast<int>(l), verdicts_[l], stored);
        if (campaign_.sources[static_cast<std::size_t>(source_)].axis != Axis::none)
          result.extremes.excuse(extremes_[i], static_cast<int>(l), verdicts_[l], stored);
        verdicts_[l] = truth(i);
        continue;
      }
      any_wrong = any_wrong || is_wrong(verdicts_[l], truth(i));
    }
    if (!any_wrong) return;
    ++result.disagreements;
    const Nesting nesting = analysis::nesting_of(pair, relation);
    signatures_.add(relation, nesting, buckets_[i], verdicts_, key);
    if (!found) return;
    analysis::for_each_subject(under_test_.lanes, [&](std::size_t first, std::size_t count) {
      analysis::Signature failure =
          analysis::signature(relation, nesting, buckets_[i], std::span(under_test_.lanes).subspan(first, count),
                              std::span(verdicts_).subspan(first, count));
      if (failure.wrong()) found->failures.push_back(std::move(failure));
    });
  }

  const Campaign& campaign_;
  const SelectedLanes& under_test_;
  int source_;
  const DecideBlock& exact_;
  const std::vector<VerdictBits>& device_bits_;
  analysis::Bits truth_, none_, changed_by_storing_;  // the last is empty for float32 pairs
  std::vector<Bucket> buckets_;
  std::vector<std::int8_t> extremes_;
  BlockVerdicts decider_;
  std::span<const LaneVerdicts> views_;  // by lane, on the current block
  std::vector<Verdict> verdicts_;
  SignatureCounts signatures_;
};

}  // namespace

struct PairJudge::Parts {
  explicit Parts(const Campaign& campaign) : judge(campaign, 0, exact, device_bits) {}

  DecideBlock exact;
  std::vector<VerdictBits> device_bits;
  BlockJudge judge;
  Found found{};
};

PairJudge::PairJudge(const Campaign& campaign) : parts_(std::make_unique<Parts>(campaign)) {}
PairJudge::~PairJudge() = default;

const PairJudge::Found& PairJudge::judge(const AnyPair& pair, std::uint64_t index, BatchResult& total) {
  const Pair stored = pair.in_float32();
  const std::span<const DoublePair> doubles(&pair.doubles, pair.floats ? 0 : 1);
  parts_->found.failures.clear();
  parts_->judge.judge({{&stored, 1}, doubles}, {&index, 1}, 0, total, &parts_->found);
  parts_->judge.add_signatures(total);
  return parts_->found;
}

BatchResult no_counts(const Campaign& campaign) {
  return BatchResult(analysis::Tally(analysis::cpu_twins(campaign.under_test->lanes)));
}

BatchResult judge(const Campaign& campaign, int source_number, std::size_t count,
                  const std::function<std::uint64_t(std::size_t)>& index_of, const DecideBlock& exact) {
  const strata::PairSource& source = campaign.sources[static_cast<std::size_t>(source_number)];
  std::vector<Pair> pairs(count);
  std::vector<DoublePair> doubles(source.in_doubles() ? count : 0);
  std::vector<std::uint64_t> indices(count);
  const std::size_t block_pairs = std::clamp(count / 16 / 64 * 64, std::size_t{64}, kBlockPairs);
  const std::size_t blocks = (count + block_pairs - 1) / block_pairs;
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    const std::size_t begin = block * block_pairs, size = std::min(count - begin, block_pairs);
    for (std::size_t i = begin; i < begin + size; ++i) {
      indices[i] = index_of(i);
      if (source.in_doubles()) doubles[i] = source.double_pair(indices[i]);
      pairs[i] = source.in_doubles() ? stored_in_float32(doubles[i]) : source.pair(indices[i]);
    }
    const std::vector<std::uint32_t> order = bring_together(std::span(pairs).subspan(begin, size));
    reorder(std::span(pairs).subspan(begin, size), order);
    reorder(std::span(indices).subspan(begin, size), order);
    if (source.in_doubles()) reorder(std::span(doubles).subspan(begin, size), order);
  });

  const std::vector<const Lane*> device_lanes = campaign.under_test->device_lanes();
  std::vector<VerdictBits> device_bits;
  if (!device_lanes.empty()) campaign.under_test->device->decide(pairs, device_lanes, device_bits, doubles);

  const BatchResult empty = no_counts(campaign);
  tbb::enumerable_thread_specific<BatchResult> results(empty);
  tbb::enumerable_thread_specific<BlockJudge> judges(
      [&] { return BlockJudge(campaign, source_number, exact, device_bits); });
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    const std::size_t begin = block * block_pairs, size = std::min(count - begin, block_pairs);
    PairsToJudge block_of{std::span(pairs).subspan(begin, size)};
    if (source.in_doubles()) block_of.doubles = std::span(doubles).subspan(begin, size);
    judges.local().judge(block_of, std::span(indices).subspan(begin, size), begin, results.local());
  });
  BatchResult total = empty;
  for (const BatchResult& part : results) total.add(part);
  for (BlockJudge& part : judges) part.add_signatures(total);
  return total;
}

}  // namespace graze::fuzz
