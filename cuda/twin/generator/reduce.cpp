// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/generator/reduce.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/fnv1a.h"
#include "cuda/twin/generator/ptx_writer.h"

namespace graze::cuda::twin {
namespace {

// The name of the called function; empty if the instruction is not a call.
std::string called(const Instruction& i) {
  if (!i.is_operation() || i.op[0] != "call") return "";
  for (const std::string& operand : i.operands) {
    if (operand[0] != '(') return operand;
  }
  return "";
}

bool is_fma(const Instruction& i) {
  return i.is_operation() && i.op[0] == "fma" && (i.op.back() == "f32" || i.op.back() == "f64");
}

std::pair<std::string, int> line_of(const Module& module, const Instruction& i) {
  const auto file = module.files.find(i.source.at.file);
  return {file == module.files.end() ? "" : file->second, i.source.at.line};
}

}  // namespace

Module reduced(const Module& module, const std::string& kernel) {
  std::set<std::string> kept, waiting = {kernel};
  while (!waiting.empty()) {
    const std::string name = *waiting.begin();
    waiting.erase(waiting.begin());
    if (!kept.insert(name).second) continue;
    for (const Kernel& one : module.kernels) {
      if (one.name != name) continue;
      for (const Instruction& i : one.body) {
        if (const std::string to = called(i); !to.empty()) waiting.insert(to);
      }
    }
  }
  Module result = module;
  std::erase_if(result.kernels, [&](const Kernel& one) { return !kept.contains(one.name); });
  if (std::none_of(result.kernels.begin(), result.kernels.end(), [](const Kernel& one) { return !one.is_function; }))
    throw PtxError(module.path + ":0: expected the kernel " + kernel);
  int writes = 0;
  for (const Kernel& one : result.kernels) {
    for (const Instruction& i : one.body) {
      if (!i.is_operation() || i.op[0] != "st" || !i.has("global")) continue;
      if (++writes > 1)
        throw PtxError(
            fmt::format("{}:{}: a write to global memory cannot be replayed: {}", module.path, i.line, text(i)));
    }
  }
  return result;
}

Lines lines_with_fma(const Module& module) {
  Lines lines;
  for (const Kernel& kernel : module.kernels) {
    for (const Instruction& i : kernel.body) {
      if (is_fma(i)) lines.insert(line_of(module, i));
    }
  }
  return lines;
}

void mark_by_hand(Module& module, const Lines& lines) {
  for (Kernel& kernel : module.kernels) {
    for (Instruction& i : kernel.body) i.by_hand = is_fma(i) && lines.contains(line_of(module, i));
  }
}

std::string module_hash(const Module& module) {
  std::uint64_t hash = fnv1a("");
  std::string all;
  for (const Kernel& kernel : module.kernels) all = kernel_hash(kernel, contract(module, kernel)) + all;
  if (module.kernels.size() == 1 && module.tables.empty()) return all;
  for (const Table& table : module.tables) all += table.declaration;
  hash = fnv1a(all, hash);
  return fmt::format("{:016x}", hash);
}

}  // namespace graze::cuda::twin
