// SPDX-License-Identifier: Apache-2.0
#include "analysis/blame.h"

#include <bit>
#include <optional>
#include <string_view>

namespace graze::analysis {
namespace {

// A set of sites, one bit for each site in program order.
struct Set {
  std::size_t sites;
  std::vector<std::uint64_t> bits = std::vector<std::uint64_t>(sites / 64 + 1);

  bool has(std::size_t site) const { return bits[site / 64] >> (site % 64) & 1; }
  void flip(std::size_t site) { bits[site / 64] ^= std::uint64_t{1} << (site % 64); }
  int size() const {
    int sum = 0;
    for (const std::uint64_t word : bits) sum += std::popcount(word);
    return sum;
  }
  bool operator==(const Set&) const = default;
};

Set others(Set set) {
  for (std::size_t i = 0; i < set.sites; ++i) set.flip(i);
  return set;
}

// A kernel in which any set of sites can be fused.
class Fusing {
 public:
  Fusing(const Lane& lane, const AnyPair& pair, const std::function<void()>& asked)
      : lane_(lane), pair_(pair), asked_(asked), sites_(cuda::contraction_sites(lane, pair)) {}

  Set none() const { return {sites_.size()}; }
  Set all() const { return others(none()); }
  Verdict verdict(const Set& fused) const {
    if (asked_) asked_();
    return cuda::decide_fusing(lane_, pair_, fused.bits);
  }
  // All sites except those on the lines of the set.
  Set on_other_lines(const Set& set) const {
    Set result = all();
    for (std::size_t i = 0; i < set.sites; ++i) {
      for (std::size_t j = 0; j < set.sites; ++j) {
        const cuda::SourceLine &of_set = sites_[j].at, &at = sites_[i].at;
        if (!set.has(j) || of_set.line != at.line || std::string_view(of_set.file) != at.file) continue;
        result.flip(i);
        break;
      }
    }
    return result;
  }
  std::vector<cuda::ContractionSite> named(const Set& set) const {
    std::vector<cuda::ContractionSite> result;
    for (std::size_t i = 0; i < set.sites; ++i) {
      if (set.has(i)) result.push_back(sites_[i]);
    }
    return result;
  }

 private:
  const Lane& lane_;
  const AnyPair& pair_;
  const std::function<void()>& asked_;
  std::span<const cuda::ContractionSite> sites_;
};

// Finds a set of one or two sites. Prefers the first set that is sufficient (fusing only it gives the verdict) and
// necessary (fusing all others does not). Otherwise returns the first of the smallest sufficient sets, or nothing.
std::optional<Set> one_or_two(const Fusing& kernel, Verdict verdict) {
  std::vector<Set> enough;
  Set set = kernel.none();
  for (const bool pairs : {false, true}) {
    const std::size_t before = enough.size();
    for (std::size_t i = 0; i < set.sites; ++i) {
      set.flip(i);
      for (std::size_t j = i + 1; j < (pairs ? set.sites : i + 2); ++j) {
        if (pairs) set.flip(j);
        if (kernel.verdict(set) == verdict) enough.push_back(set);
        if (pairs) set.flip(j);
      }
      set.flip(i);
    }
    for (std::size_t i = before; i < enough.size(); ++i) {
      if (kernel.verdict(others(enough[i])) != verdict) return enough[i];
    }
  }
  return enough.empty() ? std::nullopt : std::optional(enough.front());
}

// Removes sites, from the last to the first, as long as the verdict stays the same.
Set reduced(const Fusing& kernel, Set set, Verdict verdict) {
  for (int left = set.size() + 1; set.size() < left;) {
    left = set.size();
    for (std::size_t i = set.sites; i-- > 0;) {
      if (!set.has(i)) continue;
      set.flip(i);
      if (kernel.verdict(set) != verdict) set.flip(i);
    }
  }
  return set;
}

}  // namespace

Blame blame(const Lane& lane, const AnyPair& pair, const std::function<void()>& asked) {
  const Fusing kernel(lane, pair, asked);
  const Verdict verdict = kernel.verdict(kernel.all());
  if (verdict == kernel.verdict(kernel.none())) return {};
  const std::optional<Set> few = one_or_two(kernel, verdict);
  const Set set = few ? *few : reduced(kernel, kernel.all(), verdict);
  // As long as the sites outside `needed` are also sufficient, adds a sufficient set of them.
  Set needed = set;
  while (kernel.verdict(others(needed)) == verdict) {
    const Set more = reduced(kernel, others(needed), verdict);
    for (std::size_t i = 0; i < needed.bits.size(); ++i) needed.bits[i] |= more.bits[i];
  }
  const auto made_of = [&](const Set& sites, bool smallest) {
    const bool lines_decide = kernel.verdict(kernel.on_other_lines(sites)) == kernel.verdict(kernel.none());
    return Blame{kernel.named(sites), smallest, lines_decide, {}};
  };
  if (needed != set && kernel.verdict(needed) == verdict) return made_of(needed, false);
  return made_of(set, few || set.size() <= 3);
}

}  // namespace graze::analysis
