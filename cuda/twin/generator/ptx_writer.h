// SPDX-License-Identifier: Apache-2.0
// Writes a module as PTX: in the form stored in the repository, or with every contraction written out.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

#include "cuda/twin/generator/contraction.h"
#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {

// Writes the module in a form that is the same on every machine. Paths are relative to `root`; nvcc's comments and the
// mangled names of inlined functions are left out. The source lines of operations that may be contracted are kept.
void write_stored(std::ostream& out, const Module& module, const std::string& root);

// Writes the module after the contraction pass, which leaves ptxas no choice.
void write_explicit(std::ostream& out, const Module& module, Rule rule);

// Hash of a kernel's instructions, both as they stand and as the pass contracts them. File names, lines and the
// kernel's own name do not count. 16 hexadecimal digits (FNV-1a, 64 bits).
std::string kernel_hash(const Kernel& kernel, const Contracted& contracted);

}  // namespace graze::cuda::twin
