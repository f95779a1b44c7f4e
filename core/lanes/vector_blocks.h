// SPDX-License-Identifier: Apache-2.0
// Block functions of published lanes that decide several pairs at a time, in the processor's vector registers.
#pragma once

#include "core/lanes/lanes.h"

namespace graze {

// A vectorised block function for a `cpu` lane; null if there is none. The function performs the same operations on
// each pair in the same order as the lane's algorithm, so its verdicts are the same. It uses AVX-512 or AVX2; without
// both, it decides one pair at a time.
DecideBlock::Function vector_block(std::string_view algorithm, Scalar scalar);

}  // namespace graze
