// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/confirmation.h"

#include <fmt/format.h>

#include <algorithm>

#include "fuzz/campaign/cpu_engine.h"
#include "oracle/truth.h"

namespace graze::fuzz {

void Confirmation::confirm(int source, BatchResult& result) {
  std::map<std::uint64_t, std::vector<analysis::Signature>> fresh;
  for (const auto& [signature, found] : result.signatures) {
    SignatureCount& known = confirmed_[signature];
    const std::vector<CaseKey> before = known.cases;
    known.add(found);
    for (const CaseKey& kept : known.cases) {
      if (std::find(before.begin(), before.end(), kept) == before.end()) fresh[kept.index].push_back(signature);
    }
  }
  std::vector<std::uint64_t> indices;
  for (const auto& [index, signatures] : fresh) indices.push_back(index);
  const BatchResult judged = judge(campaign_, source, indices.size(), [&](std::size_t i) { return indices[i]; });
  for (const auto& [index, signatures] : fresh) {
    for (const analysis::Signature& signature : signatures) {
      const auto found = judged.signatures.find(signature);
      const bool same = found != judged.signatures.end() &&
                        std::find(found->second.cases.begin(), found->second.cases.end(), CaseKey{index, source}) !=
                            found->second.cases.end();
      if (!same) {
        throw oracle::OracleMismatch(fmt::format("the exact lane and the oracle differ on {}:{}:{}: the lane says {}",
                                                 campaign_.sources[static_cast<std::size_t>(source)].id, campaign_.seed,
                                                 index, analysis::key(signature)));
      }
    }
  }
  result.cgal += judged.cgal;
  result.gmp += judged.gmp;
}

}  // namespace graze::fuzz
