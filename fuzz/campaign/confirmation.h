// SPDX-License-Identifier: Apache-2.0
// When the exact lane judges, on the CPU or on devices, CGAL and GMP check each kept case.
#pragma once

#include <map>

#include "fuzz/campaign/campaign.h"

namespace graze::fuzz {

class Confirmation {
 public:
  // Requires: `campaign` outlives this object.
  explicit Confirmation(const Campaign& campaign) : campaign_(campaign) {}

  // Lets the oracle judge the cases of `result` that would be kept and that the oracle has not judged yet.
  // Throws: OracleMismatch if the oracle contradicts the result on a case.
  void confirm(int source, BatchResult& result);

 private:
  const Campaign& campaign_;
  std::map<analysis::Signature, SignatureCount> confirmed_;  // the cases kept so far
};

}  // namespace graze::fuzz
