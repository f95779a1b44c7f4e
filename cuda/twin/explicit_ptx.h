// SPDX-License-Identifier: Apache-2.0
// The kernels' PTX with every contraction written out, as text for the driver to assemble; see cuda/twin/prove.h.
#pragma once

#include <string>

#include "core/variants.h"

namespace graze::cuda {

// The variant's text. wrong_rule: with wrong contractions.   Throws: std::invalid_argument for a variant without a
// twin.
std::string explicit_ptx(Variant variant, bool wrong_rule);

}  // namespace graze::cuda
