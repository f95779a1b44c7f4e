// SPDX-License-Identifier: Apache-2.0
// Blocks of a kernel, and which registers are alive at their ends: what the contraction pass asks of the control flow.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {

// Registers that an instruction reads and writes; memory operands are read.
std::vector<std::string> registers_read(const Instruction& instruction);
std::vector<std::string> registers_written(const Instruction& instruction);

struct Block {
  std::vector<std::size_t> instructions;  // places in Kernel::body, in the order of execution
  std::vector<std::size_t> successors;    // places in Flow::blocks
  std::set<std::string> alive_at_end;     // registers that a successor may read before writing them
};

// The kernel's basic blocks. A block whose only successor has no other predecessor is one block with it.
// Throws: PtxError for a jump to a label that is not there.
std::vector<Block> blocks(const Module& module, const Kernel& kernel);

}  // namespace graze::cuda::twin
