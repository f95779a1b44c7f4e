// SPDX-License-Identifier: Apache-2.0
// What several stores hold together: of each source one sum, and which pairs are in it. Its size is that of the sources
// and their signatures, however many stores there are.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "fuzz/campaign/stored_counts.h"

namespace graze::fuzz {

class Sums {
 public:
  // Requires: the sources outlive this.
  Sums(const std::vector<strata::PairSource>& sources, int lanes);

  // from: a number of where the row comes from.
  // Throws: Overlap when some of the pairs are in it already.
  void add(const PairRange& range, const StoredCounts& counts, std::size_t from);

  struct Overlap {
    PairRange pairs;
    std::size_t before, now;
  };

  // What is missing of the source's pairs within these, in order.
  std::vector<PairRange> gaps(const PairRange& within) const;
  // The same of all sources.
  std::vector<PairRange> gaps() const;

  const StoredCounts& of_source(int source) const { return of_source_[static_cast<std::size_t>(source)]; }

  // As bytes and back, from another rank of the same campaign.   Throws: Damaged.
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
      covered_;  // of each source, by their first pair; neighbours of one origin are one
};

}  // namespace graze::fuzz
