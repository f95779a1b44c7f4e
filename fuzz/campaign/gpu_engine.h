// SPDX-License-Identifier: Apache-2.0
// Judges pairs of float32 or of doubles on the devices. The CPU engine, and with it CGAL and GMP, also judges the kept
// cases and the few pairs that the devices leave undecided.
#pragma once

#include "fuzz/campaign/confirmation.h"

namespace graze::fuzz {

// Judges the pairs, split among the campaign's engines.
// Requires: the confirmation is the campaign's.
// Throws: OracleMismatch if a kept case contradicts the device's result.
BatchResult judge_on_devices(const Campaign& campaign, const PairRange& range, Confirmation& confirmation);

}  // namespace graze::fuzz
