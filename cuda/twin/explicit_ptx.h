// SPDX-License-Identifier: Apache-2.0
// The kernels' PTX with every contraction written out, as text for the driver to assemble; see cuda/twin/prove.h.
#pragma once

#include <string>

namespace graze::cuda {

std::string explicit_ptx(bool contracted, bool wrong_rule);

}  // namespace graze::cuda
