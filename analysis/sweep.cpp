// SPDX-License-Identifier: Apache-2.0
#include "analysis/sweep.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>

#include "core/exact/exact.h"
#include "core/judged_bits.h"
#include "core/lanes/ladder.h"
#include "cuda/engine/sweep.h"
#include "cuda/twin/twin.h"

namespace graze::analysis {
namespace {

constexpr std::size_t kBlock = 1024;  // pairs that are drawn and judged, then decided under all policies
constexpr std::size_t kWords = kBlock / 64;

struct Verdicts {
  std::array<std::uint64_t, kWords> intersects{}, declined{};
};

Verdicts verdicts(const DecideBlock& decide, const std::vector<Pair>& pairs) {
  Verdicts result;
  decide(pairs.data(), pairs.size(), result.intersects.data(), result.declined.data());
  return result;
}

void keep_first(std::optional<PairPlace>& kept, const std::optional<PairPlace>& found) {
  if (found && (!kept || *found < *kept)) kept = found;
}

// Counts the bits, and keeps the first one's place.
void add(std::uint64_t bits, const PairPlace& word, std::uint64_t& count, std::optional<PairPlace>& first) {
  if (bits == 0) return;
  count += static_cast<std::uint64_t>(std::popcount(bits));
  keep_first(first, PairPlace{word.source, word.index + static_cast<std::uint64_t>(std::countr_zero(bits))});
}

void add(const SourceBlock& block, const Verdicts& truth, const Verdicts& without, const std::uint64_t* intersects,
         const std::uint64_t* declined, PolicyErrors& errors) {
  for (std::size_t w = 0; w * 64 < block.count; ++w) {
    const std::uint64_t judged = ~truth.declined[w];  // a pair that is not finite is not counted
    const JudgedBits now = judge(intersects[w], declined[w], truth.intersects[w], judged);
    const JudgedBits before = judge(without.intersects[w], without.declined[w], truth.intersects[w], judged);
    errors.false_positive += static_cast<std::uint64_t>(std::popcount(now.false_positive));
    errors.false_negative += static_cast<std::uint64_t>(std::popcount(now.false_negative));
    errors.declined += static_cast<std::uint64_t>(std::popcount(now.declined));
    const PairPlace word{block.source, block.first + w * 64};
    add(before.not_right() & ~now.not_right(), word, errors.fixed, errors.first_fixed);
    add(now.not_right() & ~before.not_right(), word, errors.broken, errors.first_broken);
  }
  errors.pairs += block.count;
}

// Policies that are decided together, by their places.
struct Together {
  std::vector<std::size_t> places;
  DecideBlock one;                // of a single policy
  DecideLadder ladder = nullptr;  // of several
  std::vector<Epsilons> rungs;
};

std::vector<PolicyErrors> run(const DecideBlock& zero, const std::vector<Together>& parts, Policies policies,
                              Sources sources, int threads) {
  const DecideBlock exact = find_lane("exact/f32/cpu")->decide;
  std::vector<PolicyErrors> errors;
  for (const std::string& policy : policies) errors.emplace_back().policy = policy;
  const std::vector<SourceBlock> blocks = blocks_of(sources, kBlock);
  const auto count = static_cast<std::size_t>(threads > 0 ? threads : tbb::info::default_concurrency());
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, count);
  tbb::enumerable_thread_specific<std::vector<PolicyErrors>> results(errors);
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
    const SourceBlock& block = blocks[b];
    std::vector<Pair> pairs;
    for (std::uint64_t i = 0; i < block.count; ++i)
      pairs.push_back(sources[static_cast<std::size_t>(block.source)].pair(block.first + i));
    const Verdicts truth = verdicts(exact, pairs), without = verdicts(zero, pairs);
    std::vector<PolicyErrors>& result = results.local();
    std::vector<std::uint64_t> intersects, declined;
    for (const Together& part : parts) {
      const std::size_t words = (pairs.size() + 63) / 64;
      intersects.resize(words * part.places.size());
      declined.resize(intersects.size());
      if (part.ladder) {
        part.ladder(part.rungs, pairs.data(), pairs.size(), intersects.data(), declined.data());
      } else {
        part.one(pairs.data(), pairs.size(), intersects.data(), declined.data());
      }
      for (std::size_t p = 0; p < part.places.size(); ++p)
        add(block, truth, without, &intersects[p * words], &declined[p * words], result[part.places[p]]);
    }
  });
  for (const std::vector<PolicyErrors>& some : results) {
    for (std::size_t p = 0; p < some.size(); ++p) errors[p] += some[p];
  }
  return errors;
}

// Whether the second may follow the first on a ladder.
bool rises(const Epsilons& first, const Epsilons& second) {
  for (int s = 0; s < kSiteCount; ++s) {
    if (!(first.absolute[s] <= second.absolute[s] && first.relative[s] <= second.relative[s])) return false;
  }
  return first.any_relative() == second.any_relative();
}

// As few ladders as the policies' order allows: a sweep names a curve's tolerances one after the other.
std::vector<Together> parts_of(const Lane& lane, Policies policies) {
  std::vector<Together> parts;
  for (std::size_t p = 0; p < policies.size(); ++p) {
    const Lane under = policies[p].empty() ? lane : lane_under(lane, policies[p]);
    const bool tolerances = under.under && under.under->kind == Policy::Kind::tolerances;
    const DecideLadder ladder = tolerances ? ladder_of(lane, under.under->epsilons.any_relative()) : nullptr;
    if (!ladder) {
      parts.push_back({{p}, cuda::block_on_host(under), nullptr, {}});
    } else if (!parts.empty() && parts.back().ladder && rises(parts.back().rungs.back(), under.under->epsilons)) {
      parts.back().places.push_back(p);
      parts.back().rungs.push_back(under.under->epsilons);
    } else {
      parts.push_back({{p}, {}, ladder, {under.under->epsilons}});
    }
  }
  return parts;
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

PolicyErrors& PolicyErrors::operator+=(const PolicyErrors& other) {
  Counts::operator+=(other);
  pairs += other.pairs;
  fixed += other.fixed;
  broken += other.broken;
  keep_first(first_fixed, other.first_fixed);
  keep_first(first_broken, other.first_broken);
  return *this;
}

Sweep host_sweep(DecideUnder decide, int threads) {
  return [decide = std::move(decide), threads](Policies policies, Sources sources) {
    std::vector<Together> parts;
    for (std::size_t p = 0; p < policies.size(); ++p) parts.push_back({{p}, decide(policies[p]), nullptr, {}});
    return run(decide(""), parts, policies, sources, threads);
  };
}

Sweep host_sweep(const Lane& lane, int threads) {
  return [&lane, threads](Policies policies, Sources sources) {
    return run(cuda::block_on_host(lane), parts_of(lane, policies), policies, sources, threads);
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
