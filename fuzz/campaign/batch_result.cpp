// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/batch_result.h"

#include <algorithm>

namespace graze::fuzz {

void SignatureCount::keep(const CaseKey& found) {
  if (cases.size() == kKeptCases && cases.back() < found) return;
  cases.insert(std::upper_bound(cases.begin(), cases.end(), found), found);
  if (cases.size() > kKeptCases) cases.pop_back();
}

void SignatureCount::add(const CaseKey& found) {
  ++count;
  keep(found);
}

void SignatureCount::add(const SignatureCount& other) {
  count += other.count;
  for (const CaseKey& found : other.cases) keep(found);
}

void VerdictDigests::add(std::size_t lane, std::uint64_t index, Verdict verdict) {
  // splitmix64 of a number that is unique to the pair and verdict.   Reference: Steele, Lea and Flood 2014.
  std::uint64_t z = (index * 8 + static_cast<std::uint64_t>(verdict) + 1) * 0x9e3779b97f4a7c15;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
  z = (z ^ z >> 27) * 0x94d049bb133111eb;
  of_lane[lane] += z ^ z >> 31;
}

void VerdictDigests::add(const VerdictDigests& other) {
  for (std::size_t l = 0; l < of_lane.size(); ++l) of_lane[l] += other.of_lane[l];
  pairs += other.pairs;
}

void PairCounts::add(const PairCounts& other) {
  tally.add(other.tally);
  extremes.add(other.extremes);
  digests.add(other.digests);
  disagreements += other.disagreements;
  cgal += other.cgal;
  gmp += other.gmp;
  exact += other.exact;
}

}  // namespace graze::fuzz
