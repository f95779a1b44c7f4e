// SPDX-License-Identifier: Apache-2.0
// Writes a kernel as C++ that does on the CPU what one device thread does, operation by operation.
#pragma once

#include <iosfwd>

#include "cuda/twin/generator/contraction.h"
#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {

// Writes a struct for each kernel, the functions that it calls, and a list of all kernels. The output is included after
// cuda/twin/twin_ops_bits.h and twin_ops_rounding.h, in the namespace of the executor. The thread is alone: index 0 of
// one block of one thread; a ballot sees only its own bit.
// Throws: PtxError for an unknown instruction or one that cannot be replayed.
void write_cpp(std::ostream& out, const Module& module, Rule rule);

}  // namespace graze::cuda::twin
