// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "strata/pair_source.h"

namespace graze::cuda {

// Draws pairs [first, first + count) into the memory of the first device, and copies them back. For a source of
// doubles, `floats` has the pairs as the device rounds them to float32.
// Throws: std::runtime_error on any CUDA error.
strata::PairBlock drawn_for_device(const strata::PairSource& source, std::uint64_t first, std::uint32_t count);

}  // namespace graze::cuda
