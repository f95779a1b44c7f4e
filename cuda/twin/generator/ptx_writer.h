// SPDX-License-Identifier: Apache-2.0
// Writes PTX: a module as the repository keeps it, and one with every contraction written out.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

#include "cuda/twin/generator/contraction.h"
#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {

// The module in one spelling on every machine: paths relative to `root`, neither comments of nvcc nor mangled names of
// inlined functions, but with the source lines of what may be contracted.
void write_stored(std::ostream& out, const Module& module, const std::string& root);

// The module after the contraction pass: nothing is left for ptxas to choose.
void write_explicit(std::ostream& out, const Module& module, Rule rule);

// Hash of a kernel's instructions as they stand and as the pass contracts them. Names of files, lines and the
// kernel's own name do not enter. 16 hexadecimal digits (FNV-1a, 64 bits).
std::string kernel_hash(const Kernel& kernel, const Contracted& contracted);

}  // namespace graze::cuda::twin
