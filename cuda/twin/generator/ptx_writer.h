// SPDX-License-Identifier: Apache-2.0
// Writes a module as PTX, in the form stored in the repository or with every contraction written out.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

#include "cuda/twin/generator/contraction.h"
#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {

// Writes the module in a form that is the same on every machine: paths are relative to `root`, and nvcc's comments and
// the mangled names of inlined functions are left out. Operations that may be contracted keep their source lines.
void write_stored(std::ostream& out, const Module& module, const std::string& root);

// Writes the module after the contraction pass, so that ptxas cannot contract further.
void write_explicit(std::ostream& out, const Module& module, Rule rule);

// The hash of a kernel's instructions before and after the contraction pass: 16 hexadecimal digits (FNV-1a, 64 bits).
// File names, lines and the kernel's own name do not change the hash.
std::string kernel_hash(const Kernel& kernel, const Contracted& contracted);

}  // namespace graze::cuda::twin
