// SPDX-License-Identifier: Apache-2.0
// Judges float32 pairs or pairs of doubles on the devices. The CPU engine, with CGAL and GMP, also judges the kept
// cases and the few pairs that the devices leave undecided.
#pragma once

#include "fuzz/campaign/confirmation.h"

namespace graze::fuzz {

// Splits the pairs among the campaign's engines, and judges them.
// Requires: `confirmation` belongs to `campaign`.
// Throws: OracleMismatch if a kept case contradicts the device's result.
BatchResult judge_on_devices(const Campaign& campaign, const PairRange& range, Confirmation& confirmation);

}  // namespace graze::fuzz
