// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "strata/pair_source.h"

namespace graze::cuda {

// Like strata::pairs_of, drawn for the first device. For doubles, `floats` has the pairs that the device stores.
// Throws: std::runtime_error on any CUDA error.
strata::PairBlock drawn_for_device(const strata::PairSource& source, std::uint64_t first, std::uint32_t count);

}  // namespace graze::cuda
