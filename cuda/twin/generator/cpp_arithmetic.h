// SPDX-License-Identifier: Apache-2.0
// Writes PTX arithmetic as C++ statements that call the functions of cuda/twin/twin_ops*.h.
#pragma once

#include <string>

#include "cuda/twin/generator/cpp_operands.h"

namespace graze::cuda::twin {

// Throws: PtxError for an instruction that is unknown or cannot be replayed.
std::string floating_statement(const Operands& operands);
std::string integer_statement(const Operands& operands);

}  // namespace graze::cuda::twin
