// SPDX-License-Identifier: Apache-2.0
// Writes one PTX instruction as a C++ statement that calls the functions of cuda/twin/twin_ops.h.
#pragma once

#include <string>

#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {

// The instruction as a statement of the function `run`; see cpp_writer.h.   Requires: not a label.
// Throws: PtxError for an instruction that is unknown or cannot be replayed.
std::string cpp_statement(const Module& module, const Kernel& kernel, const Instruction& instruction);

}  // namespace graze::cuda::twin
