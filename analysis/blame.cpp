// SPDX-License-Identifier: Apache-2.0
#include "analysis/blame.h"

namespace graze::analysis {
namespace {

// A kernel with some sites fused.
class Fusing {
 public:
  Fusing(const Lane& lane, const Pair& pair)
      : lane_(lane), pair_(pair), sites_(cuda::contraction_sites(lane)), bits_(sites_.size() / 64 + 1) {}

  std::size_t size() const { return sites_.size(); }
  void set(std::size_t site, bool fused) {
    const std::uint64_t bit = std::uint64_t{1} << (site % 64);
    bits_[site / 64] = fused ? bits_[site / 64] | bit : bits_[site / 64] & ~bit;
  }
  void set_all(bool fused) {
    for (std::size_t i = 0; i < size(); ++i) set(i, fused);
  }
  Verdict verdict() const { return cuda::decide_fusing(lane_, pair_, bits_); }
  std::vector<cuda::ContractionSite> fused() const {
    std::vector<cuda::ContractionSite> result;
    for (std::size_t i = 0; i < size(); ++i) {
      if (bits_[i / 64] >> (i % 64) & 1) result.push_back(sites_[i]);
    }
    return result;
  }

 private:
  const Lane& lane_;
  const Pair& pair_;
  std::span<const cuda::ContractionSite> sites_;
  std::vector<std::uint64_t> bits_;
};

// Leaves the first of the single sites that give the verdict fused, or else the first two.
bool find_one_or_two(Fusing& kernel, Verdict verdict) {
  kernel.set_all(false);
  for (std::size_t i = 0; i < kernel.size(); ++i) {
    kernel.set(i, true);
    if (kernel.verdict() == verdict) return true;
    kernel.set(i, false);
  }
  for (std::size_t i = 0; i < kernel.size(); ++i) {
    kernel.set(i, true);
    for (std::size_t j = i + 1; j < kernel.size(); ++j) {
      kernel.set(j, true);
      if (kernel.verdict() == verdict) return true;
      kernel.set(j, false);
    }
    kernel.set(i, false);
  }
  return false;
}

// Parts all sites from the last one on as long as the verdict stays, until none can be parted any more.
void reduce(Fusing& kernel, Verdict verdict) {
  kernel.set_all(true);
  for (std::size_t left = kernel.size() + 1; kernel.fused().size() < left;) {
    left = kernel.fused().size();
    for (std::size_t i = kernel.size(); i-- > 0;) {
      kernel.set(i, false);
      if (kernel.verdict() != verdict) kernel.set(i, true);
    }
  }
}

}  // namespace

Blame blame(const Lane& lane, const Pair& pair) {
  Fusing kernel(lane, pair);
  const Verdict without = kernel.verdict();
  kernel.set_all(true);
  const Verdict verdict = kernel.verdict();
  if (verdict == without) return {};
  if (find_one_or_two(kernel, verdict)) return {kernel.fused(), true};
  reduce(kernel, verdict);
  std::vector<cuda::ContractionSite> sites = kernel.fused();
  const bool smallest = sites.size() <= 3;
  return {std::move(sites), smallest};
}

}  // namespace graze::analysis
