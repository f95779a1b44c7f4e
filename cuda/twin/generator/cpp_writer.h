// SPDX-License-Identifier: Apache-2.0
// Writes a kernel as C++ that does on the CPU what one thread does on a device, operation by operation.
#pragma once

#include <iosfwd>

#include "cuda/twin/generator/contraction.h"
#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {

// Writes one struct a kernel and the list of them, for inclusion after cuda/twin/twin_ops_bits.h and
// twin_ops_rounding.h in the namespace of the executor, with the functions that it calls. The thread is alone: index 0
// of one block of one thread; of a ballot it sees its own bit. Throws: PtxError for an instruction that is unknown or
// cannot be replayed.
void write_cpp(std::ostream& out, const Module& module, Rule rule);

}  // namespace graze::cuda::twin
