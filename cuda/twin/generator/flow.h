// SPDX-License-Identifier: Apache-2.0
// A kernel's basic blocks and the registers that are alive at their ends, for the contraction pass.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {

// The registers that an instruction reads, and those that it writes. The registers in a memory operand are read.
std::vector<std::string> registers_read(const Instruction& instruction);
std::vector<std::string> registers_written(const Instruction& instruction);

struct Block {
  std::vector<std::size_t> instructions;  // indices in Kernel::body, in order of execution
  std::vector<std::size_t> successors;    // indices in the vector of blocks
  std::set<std::string> alive_at_end;     // registers that a successor may read before writing them
};

// The kernel's basic blocks. A block is merged with its only successor if the successor has no other predecessor.
// Throws: PtxError for a jump to an unknown label.
std::vector<Block> blocks(const Module& module, const Kernel& kernel);

}  // namespace graze::cuda::twin
