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

void BatchResult::add(const BatchResult& other) {
  tally.add(other.tally);
  extremes.add(other.extremes);
  for (const auto& [signature, found] : other.signatures) signatures[signature].add(found);
  for (const auto& [lane, found] : other.executor_mismatches) executor_mismatches[lane].add(found);
  disagreements += other.disagreements;
  cgal += other.cgal;
  gmp += other.gmp;
  exact += other.exact;
}

}  // namespace graze::fuzz
