// SPDX-License-Identifier: Apache-2.0
// Block functions of published lanes that decide several pairs at a time, in the processor's vector registers.
#pragma once

#include "core/lanes/lanes.h"

namespace graze {

// The block function of a `cpu` lane; null if there is none. Its verdicts are those of the lane's algorithm for each
// pair alone: the same operations, rounded in the same order. It uses AVX-512 or AVX2, and otherwise decides one pair
// at a time.
DecideBlock::Function vector_block(std::string_view algorithm, Scalar scalar);

}  // namespace graze
