// SPDX-License-Identifier: Apache-2.0
// Block functions of published lanes that decide several pairs at a time, in the processor's vector registers.
#pragma once

#include "core/lanes/lanes.h"

namespace graze {

// The block function of a `cpu` lane, or null if none is written. Its verdicts are those of the lane's algorithm for
// each pair alone: the same operations, rounded in the same order. It uses AVX-512 or AVX2, and else decides one by
// one.
DecideBlock::Function vector_block(std::string_view algorithm, Scalar scalar);

}  // namespace graze
