// SPDX-License-Identifier: Apache-2.0
// Judges pairs of float32 or of doubles on the devices. The CPU engine, and with it CGAL and GMP, also judges the kept
// cases and the few pairs that the devices leave undecided.
#pragma once

#include "fuzz/campaign/confirmation.h"

namespace graze::fuzz {

class GpuEngine {
 public:
  // Requires: campaign outlives this.
  explicit GpuEngine(const Campaign& campaign) : campaign_(campaign), confirmation_(campaign) {}

  // Judges the pairs [first, first + count) of the source, split among the campaign's engines.
  // Throws: OracleMismatch if a kept case contradicts the device's result.
  BatchResult judge(int source, std::uint64_t first, std::uint64_t count);

 private:
  const Campaign& campaign_;
  Confirmation confirmation_;
};

}  // namespace graze::fuzz
