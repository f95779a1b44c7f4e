// SPDX-License-Identifier: Apache-2.0
#include "analysis/blame.h"

#include <algorithm>

namespace graze::analysis {
namespace {

using Set = std::vector<bool>;  // of sites, in program order

std::ptrdiff_t size(const Set& set) { return std::count(set.begin(), set.end(), true); }

// A kernel of which any sites can be fused.
class Fusing {
 public:
  Fusing(const Lane& lane, const Pair& pair) : lane_(lane), pair_(pair), sites_(cuda::contraction_sites(lane)) {}

  Set none() const { return Set(sites_.size()); }
  Set all() const { return Set(sites_.size(), true); }
  Verdict verdict(const Set& fused) const {
    std::vector<std::uint64_t> bits(sites_.size() / 64 + 1);
    for (std::size_t i = 0; i < fused.size(); ++i) bits[i / 64] |= std::uint64_t{fused[i]} << (i % 64);
    return cuda::decide_fusing(lane_, pair_, bits);
  }
  std::vector<cuda::ContractionSite> named(const Set& set) const {
    std::vector<cuda::ContractionSite> result;
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (set[i]) result.push_back(sites_[i]);
    }
    return result;
  }

 private:
  const Lane& lane_;
  const Pair& pair_;
  std::span<const cuda::ContractionSite> sites_;
};

Set others(Set set) {
  set.flip();
  return set;
}

// Sets of one or two sites: the first that is both enough for the verdict, fused alone, and needed for it, all others
// fused; or else the first smallest that is enough; empty where none is.
Set one_or_two(const Fusing& kernel, Verdict verdict) {
  std::vector<Set> enough;
  Set set = kernel.none();
  for (const bool pairs : {false, true}) {
    const std::size_t before = enough.size();
    for (std::size_t i = 0; i < set.size(); ++i) {
      for (std::size_t j = pairs ? i + 1 : i; j < (pairs ? set.size() : i + 1); ++j) {
        set[i] = set[j] = true;
        if (kernel.verdict(set) == verdict) enough.push_back(set);
        set[i] = set[j] = false;
      }
    }
    for (std::size_t i = before; i < enough.size(); ++i) {
      if (kernel.verdict(others(enough[i])) != verdict) return enough[i];
    }
  }
  return enough.empty() ? Set{} : enough.front();
}

// Parts sites from the last one on as long as the verdict stays, until none can be parted any more.
Set reduced(const Fusing& kernel, Set set, Verdict verdict) {
  for (std::ptrdiff_t left = size(set) + 1; size(set) < left;) {
    left = size(set);
    for (std::size_t i = set.size(); i-- > 0;) {
      if (!set[i]) continue;
      set[i] = false;
      if (kernel.verdict(set) != verdict) set[i] = true;
    }
  }
  return set;
}

}  // namespace

Blame blame(const Lane& lane, const Pair& pair) {
  const Fusing kernel(lane, pair);
  const Verdict verdict = kernel.verdict(kernel.all());
  if (verdict == kernel.verdict(kernel.none())) return {};
  Set set = one_or_two(kernel, verdict);
  const bool few = !set.empty();
  if (!few) set = reduced(kernel, kernel.all(), verdict);
  // Where the sites that are left do the same without it, one such set after the other.
  Set needed = set;
  while (kernel.verdict(others(needed)) == verdict) {
    const Set more = reduced(kernel, others(needed), verdict);
    for (std::size_t i = 0; i < needed.size(); ++i) needed[i] = needed[i] || more[i];
  }
  if (needed != set && kernel.verdict(needed) == verdict) return {kernel.named(needed), false};
  return {kernel.named(set), few || size(set) <= 3};
}

}  // namespace graze::analysis
