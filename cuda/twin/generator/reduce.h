// SPDX-License-Identifier: Apache-2.0
// Reduces a user's module to the kernel that is needed, and distinguishes its contractions from an fma in the source.
#pragma once

#include <set>
#include <string>
#include <utility>

#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {

// The kernel, the functions that it calls directly or indirectly, and all tables.
// Throws: PtxError when there is no such kernel, or when it writes to global memory other than its answer.
Module reduced(const Module& module, const std::string& kernel);

using Lines = std::set<std::pair<std::string, int>>;  // file, line

// Lines with an fma. In a module compiled without contraction, these are the lines with an fma in the source.
Lines lines_with_fma(const Module& module);

// Marks each fma on these lines as written in the source, not as a contraction.
void mark_by_hand(Module& module, const Lines& lines);

// Hash of the kernel, its functions and its tables. Without functions and tables it equals kernel_hash.
std::string module_hash(const Module& module);

}  // namespace graze::cuda::twin
