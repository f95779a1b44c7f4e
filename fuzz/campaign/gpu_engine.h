// SPDX-License-Identifier: Apache-2.0
// What the GPU engine does with pairs: all of them on the devices; the few that these leave, and each case that is
// kept, by the CPU engine as well, and so by CGAL and GMP.
#pragma once

#include "fuzz/campaign/confirmation.h"

namespace graze::fuzz {

class GpuEngine {
 public:
  // Requires: campaign outlives this.
  explicit GpuEngine(const Campaign& campaign) : campaign_(campaign), confirmation_(campaign) {}

  // Pairs [first, first + count) of the source, shared by the campaign's engines.
  // Throws: OracleMismatch when a kept case is not what the device says.
  BatchResult judge(int source, std::uint64_t first, std::uint64_t count);

 private:
  const Campaign& campaign_;
  Confirmation confirmation_;
};

}  // namespace graze::fuzz
