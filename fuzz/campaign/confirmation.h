// SPDX-License-Identifier: Apache-2.0
// Where the exact lane judges, here or on devices, CGAL and GMP judge each case that is kept once more.
#pragma once

#include <map>

#include "fuzz/campaign/campaign.h"

namespace graze::fuzz {

class Confirmation {
 public:
  // Requires: campaign outlives this.
  explicit Confirmation(const Campaign& campaign) : campaign_(campaign) {}

  // Has the oracle judge those cases of the result that would be kept and that it has not judged yet.
  // Throws: OracleMismatch when a case is not what the result says.
  void confirm(int source, BatchResult& result);

 private:
  const Campaign& campaign_;
  std::map<analysis::Signature, SignatureCount> confirmed_;  // what is kept so far
};

}  // namespace graze::fuzz
