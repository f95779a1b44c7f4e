// SPDX-License-Identifier: Apache-2.0
// Writes a kernel as C++ code that performs one device thread's operations on the CPU.
#pragma once

#include <iosfwd>

#include "cuda/twin/generator/contraction.h"
#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {

// Writes a struct for each kernel, with the functions that the kernel calls, and a list of all kernels. Include the
// output after cuda/twin/twin_ops_bits.h and twin_ops_rounding.h, in a separate namespace. The kernel runs as the only
// thread of the only block, so a ballot has only this thread's bit. Throws: PtxError for an instruction that is unknown
// or cannot be replayed.
void write_cpp(std::ostream& out, const Module& module, Rule rule);

}  // namespace graze::cuda::twin
