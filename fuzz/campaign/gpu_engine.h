// SPDX-License-Identifier: Apache-2.0
// What the GPU engine does with pairs: all of them on the devices; the few that these leave, and each case that is
// kept, by the CPU engine as well, and so by CGAL and GMP.
#pragma once

#include <map>

#include "fuzz/campaign/campaign.h"

namespace graze::fuzz {

class GpuEngine {
 public:
  // Requires: campaign outlives this.
  explicit GpuEngine(const Campaign& campaign) : campaign_(campaign) {}

  // Pairs [first, first + count) of the source, shared by the campaign's engines.
  // Throws: OracleApart when a kept case is not what the device says.
  BatchResult judge(int source, std::uint64_t first, std::uint64_t count);

 private:
  // Has the oracle confirm the cases that would be kept and that it has not confirmed yet.
  void confirm(int source, BatchResult& result);

  const Campaign& campaign_;
  std::map<analysis::Signature, SignatureCount> confirmed_;  // what is kept so far
};

}  // namespace graze::fuzz
