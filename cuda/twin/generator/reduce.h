// SPDX-License-Identifier: Apache-2.0
// Reduces a user's module to one kernel, and distinguishes contractions from fma operations in the source.
#pragma once

#include <set>
#include <string>
#include <utility>

#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {

// A module with the kernel, the functions that it calls directly or indirectly, and all tables.
// Throws: PtxError if there is no such kernel, or if it has any write to global memory besides that of its answer.
Module reduced(const Module& module, const std::string& kernel);

using Lines = std::set<std::pair<std::string, int>>;  // pairs of file and line

// Lines with an fma. In a module compiled without contraction, the user wrote an fma on each of these lines.
Lines lines_with_fma(const Module& module);

// Marks each fma on these lines as written in the source, so that it does not count as a contraction.
void mark_by_hand(Module& module, const Lines& lines);

// The hash of the kernel, its functions and its tables. Without functions and tables, the hash is kernel_hash.
std::string module_hash(const Module& module);

}  // namespace graze::cuda::twin
