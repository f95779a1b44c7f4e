// SPDX-License-Identifier: Apache-2.0
// Adds up several stores. Keeps one sum for each source and the set of pairs that it covers, so memory use depends on
// the sources and their signatures, not on the number of stores.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "fuzz/campaign/stored_counts.h"

namespace graze::fuzz {

class Sums {
 public:
  // Requires: the sources outlive this object.
  Sums(const std::vector<strata::PairSource>& sources, int lanes);

  // from: identifies the row's origin.
  // Throws: Overlap if some of the pairs were added before.
  void add(const PairRange& range, const StoredCounts& counts, std::size_t from);

  struct Overlap {
    PairRange pairs;
    std::size_t before, now;
  };

  // The ranges within `within` that are missing, in order.
  std::vector<PairRange> gaps(const PairRange& within) const;
  std::vector<PairRange> gaps() const;

  const StoredCounts& of_source(int source) const { return of_source_[static_cast<std::size_t>(source)]; }

  // `bytes` encodes the sums; `add` adds such bytes from another rank of the same campaign.   Throws: Damaged.
  std::string bytes() const;
  void add(const std::string& bytes);

 private:
  struct Part {
    std::uint64_t end;
    std::size_t from;
  };
  void cover(const PairRange& range, std::size_t from);

  const std::vector<strata::PairSource>& sources_;
  int lanes_;
  std::vector<StoredCounts> of_source_;
  std::vector<std::map<std::uint64_t, Part>>
      covered_;  // by source and first pair; adjacent ranges of one origin are merged
};

}  // namespace graze::fuzz
