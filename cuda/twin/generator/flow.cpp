// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/generator/flow.h"

#include <algorithm>
#include <map>

namespace graze::cuda::twin {
namespace {

// The registers in an operand: "[%rd1+4]", "{%r1,%r2}", "%p1|%p2", "!%p3".
std::vector<std::string> registers_in(const std::string& operand) {
  std::vector<std::string> names;
  for (std::size_t at = operand.find('%'); at != std::string::npos; at = operand.find('%', at)) {
    const auto end = operand.find_first_of("+,]}|", at);
    names.push_back(operand.substr(at, end == std::string::npos ? end : end - at));
    at += names.back().size();
  }
  return names;
}

bool writes_first_operand(const Instruction& i) {
  return i.is_operation() && i.op[0] != "st" && i.op[0] != "bra" && i.op[0] != "brx" && i.op[0] != "call" &&
         i.op[0] != "ret" && i.op[0] != "exit";
}

bool leaves(const Instruction& i) {
  return i.is_operation() && i.guard.empty() && (i.op[0] == "ret" || i.op[0] == "exit");
}
bool jumps(const Instruction& i) { return i.is_operation() && (i.op[0] == "bra" || i.op[0] == "brx"); }

// A jump's target labels: its label, or the labels in its list.
std::vector<std::string> targets(const Kernel& kernel, const Instruction& i) {
  if (i.op[0] == "bra") return {i.operands.at(0)};
  const auto list = kernel.branch_targets.find(i.operands.at(1));
  return list == kernel.branch_targets.end() ? std::vector<std::string>{i.operands[1]} : list->second;
}

std::vector<Block> basic_blocks(const Module& module, const Kernel& kernel) {
  std::vector<Block> result(1);
  std::map<std::string, std::size_t> label_block;
  const auto start_new = [&] {
    if (!result.back().instructions.empty()) result.emplace_back();
  };
  for (std::size_t i = 0; i < kernel.body.size(); ++i) {
    const Instruction& instruction = kernel.body[i];
    if (instruction.is_label()) {
      start_new();
      label_block[instruction.label] = result.size() - 1;
    }
    result.back().instructions.push_back(i);
    if (jumps(instruction) || leaves(instruction)) start_new();
  }
  for (std::size_t b = 0; b < result.size(); ++b) {
    if (result[b].instructions.empty()) continue;
    const Instruction& last = kernel.body[result[b].instructions.back()];
    if (jumps(last)) {
      for (const std::string& label : targets(kernel, last)) {
        const auto target = label_block.find(label);
        if (target == label_block.end())
          throw PtxError(module.path + ":" + std::to_string(last.line) +
                         ": expected a label of this kernel: " + text(last));
        result[b].successors.push_back(target->second);
      }
    }
    if (b + 1 < result.size() && !leaves(last) && !(jumps(last) && last.guard.empty()))
      result[b].successors.push_back(b + 1);
  }
  return result;
}

void merge_chains(std::vector<Block>& all) {
  std::vector<int> predecessors(all.size(), 0);
  for (const Block& block : all) {
    for (std::size_t s : block.successors) ++predecessors[s];
  }
  predecessors[0] += 1;  // the entry of the kernel precedes the first block
  for (std::size_t b = 0; b < all.size(); ++b) {
    while (all[b].successors.size() == 1 && all[b].successors[0] != b && predecessors[all[b].successors[0]] == 1) {
      Block& next = all[all[b].successors[0]];
      if (next.instructions.empty()) break;
      all[b].instructions.insert(all[b].instructions.end(), next.instructions.begin(), next.instructions.end());
      all[b].successors = next.successors;
      next.instructions.clear();
      next.successors.clear();
    }
  }
}

void find_alive(const Kernel& kernel, std::vector<Block>& all) {
  std::vector<std::set<std::string>> alive_at_start(all.size());
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t b = all.size(); b-- > 0;) {
      std::set<std::string> alive;
      for (std::size_t s : all[b].successors) alive.insert(alive_at_start[s].begin(), alive_at_start[s].end());
      all[b].alive_at_end = alive;
      for (std::size_t k = all[b].instructions.size(); k-- > 0;) {
        const Instruction& instruction = kernel.body[all[b].instructions[k]];
        if (instruction.guard.empty()) {
          for (const std::string& name : registers_written(instruction)) alive.erase(name);
        }
        for (const std::string& name : registers_read(instruction)) alive.insert(name);
      }
      if (alive != alive_at_start[b]) {
        alive_at_start[b] = std::move(alive);
        changed = true;
      }
    }
  }
}

}  // namespace

std::vector<std::string> registers_read(const Instruction& instruction) {
  std::vector<std::string> names;
  if (!instruction.guard.empty()) names.push_back(instruction.guard);
  for (std::size_t o = writes_first_operand(instruction) ? 1 : 0; o < instruction.operands.size(); ++o) {
    for (std::string& name : registers_in(instruction.operands[o])) names.push_back(std::move(name));
  }
  return names;
}

std::vector<std::string> registers_written(const Instruction& instruction) {
  return writes_first_operand(instruction) && !instruction.operands.empty() ? registers_in(instruction.operands[0])
                                                                            : std::vector<std::string>();
}

std::vector<Block> blocks(const Module& module, const Kernel& kernel) {
  std::vector<Block> result = basic_blocks(module, kernel);
  merge_chains(result);
  find_alive(kernel, result);
  return result;
}

}  // namespace graze::cuda::twin
