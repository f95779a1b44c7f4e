// SPDX-License-Identifier: Apache-2.0
// The CPU engine judges all lanes. CGAL decides every pair; GMP confirms every disagreement and a sample. With --judge
// exact, the exact lane decides every pair, CGAL and GMP decide a sample, and Confirmation checks the kept cases.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "fuzz/campaign/campaign.h"

namespace graze::fuzz {

// Judges `count` pairs of the source, with the indices index_of(0), index_of(1), …, on the available threads.
// exact: if not null, decides instead of CGAL and GMP.
// Throws: OracleMismatch when two exact decisions differ.
BatchResult judge(const Campaign& campaign, int source, std::size_t count,
                  const std::function<std::uint64_t(std::size_t)>& index_of, const DecideBlock& exact = nullptr);

// Judges one pair at a time with host lanes and twins, and returns each pair's verdicts and failures.
class PairJudge {
 public:
  // Requires: the campaign outlives this object and has one source, and none of its lanes runs on a device.
  explicit PairJudge(const Campaign& campaign);
  ~PairJudge();

  struct Found {
    Verdict truth;
    Bucket bucket;
    std::vector<Verdict> verdicts;              // by lane; the truth if the lane's convention excuses the verdict
    std::vector<analysis::Signature> failures;  // one for each subject that is wrong
  };
  // Adds the pair's counts to `total`. All pairs have the source's coordinate type.   Throws: OracleMismatch.
  const Found& judge(const AnyPair& pair, std::uint64_t index, BatchResult& total);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// The result for no pairs: all counts of the campaign's lanes are zero.
BatchResult no_counts(const Campaign& campaign);

}  // namespace graze::fuzz
