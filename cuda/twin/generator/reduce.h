// SPDX-License-Identifier: Apache-2.0
// Of a module of others: the one kernel that counts, and what tells its contractions from an fma that a person wrote.
#pragma once

#include <set>
#include <string>
#include <utility>

#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {

// The kernel, the functions that it calls, directly or not, and all tables.
// Throws: PtxError when there is no such kernel, and where it writes to global memory more than its answer.
Module reduced(const Module& module, const std::string& kernel);

using Lines = std::set<std::pair<std::string, int>>;  // file, line

// Lines with an fma. Of a module compiled without contraction: those where a person wrote it.
Lines lines_with_fma(const Module& module);

// Says of each fma on such a line that it is no contraction.
void mark_by_hand(Module& module, const Lines& lines);

// Hash of the kernel, its functions and tables: as kernel_hash where there are none.
std::string module_hash(const Module& module);

}  // namespace graze::cuda::twin
