// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/generator/ptx_writer.h"

#include <fmt/format.h>

#include <ostream>
#include <regex>

#include "core/fnv1a.h"

namespace graze::cuda::twin {
namespace {

// Writes ".visible .entry NAME(…)" for a kernel, or ".func (…) NAME(…)" for a function.
void write_signature(std::ostream& out, const Kernel& kernel) {
  if (kernel.is_function) {
    out << "\n" << kernel.linkage << ".func ";
    if (!kernel.returned.empty()) out << "(" << kernel.returned[0].declaration << ") ";
  } else {
    out << "\n.visible .entry ";
  }
  out << kernel.name << "(\n";
  for (std::size_t p = 0; p < kernel.parameters.size(); ++p)
    out << "\t" << kernel.parameters[p].declaration << (p + 1 < kernel.parameters.size() ? ",\n" : "\n");
  out << ")\n";
}

void write_head(std::ostream& out, const Module& module) {
  out << fmt::format("// Cuda compilation tools, release {}, V{}\n.version {}\n.target {}\n.address_size 64\n",
                     module.toolkit.substr(0, module.toolkit.rfind('.')), module.toolkit, module.version,
                     module.target);
  for (const Table& table : module.tables) out << "\n" << table.declaration << ";\n";
  for (const Kernel& kernel : module.kernels) {
    if (!kernel.declared_before) continue;
    write_signature(out, kernel);
    out << ";\n";
  }
}

void write_declarations(std::ostream& out, const Kernel& kernel) {
  write_signature(out, kernel);
  out << "{\n";
  if (!kernel.local.empty())
    out << fmt::format("\t.local .align {} .b8 {}[{}];\n", kernel.local_align, kernel.local, kernel.local_bytes);
  for (const auto& [prefix, row] : kernel.registers) {
    out << fmt::format("\t.reg .{} {}{};\n", row.first, prefix, row.second ? fmt::format("<{}>", row.second) : "");
  }
}

// The path within the repository; for a system header only the file name, because its folder differs between machines.
std::string relative(std::string path, const std::string& root) {
  if (!path.starts_with(root + "/")) return path.substr(path.rfind('/') + 1);
  path.erase(0, root.size() + 1);
  while (path.starts_with("./")) path.erase(0, 2);
  return path;
}

// Whether the instruction is or may become a contraction. Only such instructions need source lines.
bool may_contract(const Instruction& i) {
  return i.is_operation() && i.op.back()[0] == 'f' &&
         (i.op[0] == "fma" || ((i.op[0] == "add" || i.op[0] == "sub") && !i.has("rn")));
}

void write_body(std::ostream& out, const Kernel& kernel, bool with_sources) {
  Source last;
  for (const Instruction& i : kernel.body) {
    if (with_sources && may_contract(i) && i.source != last && i.source.at.file != 0) {
      out << fmt::format("\t.loc {} {} {}", i.source.at.file, i.source.at.line, i.source.at.column);
      if (i.source.from.file != 0)
        out << fmt::format(" // from {} {} {}", i.source.from.file, i.source.from.line, i.source.from.column);
      out << "\n";
      last = i.source;
    }
    out << (i.is_label() ? "" : "\t") << text(i) << (i.is_operation() ? ";\n" : "\n");
  }
  out << "}\n";
}

}  // namespace

void write_stored(std::ostream& out, const Module& module, const std::string& root) {
  write_head(out, module);
  for (const Kernel& kernel : module.kernels) {
    write_declarations(out, kernel);
    write_body(out, kernel, true);
  }
  out << "\n";
  for (const auto& [number, path] : module.files) out << fmt::format(".file {} \"{}\"\n", number, relative(path, root));
}

void write_explicit(std::ostream& out, const Module& module, Rule rule) {
  write_head(out, module);
  for (const Kernel& kernel : module.kernels) {
    const Contracted contracted = contract(module, kernel, rule);
    write_declarations(out, contracted.kernel);
    write_body(out, contracted.kernel, false);
  }
}

std::string kernel_hash(const Kernel& kernel, const Contracted& contracted) {
  // The names of labels and of local memory contain the kernel's number in its module.
  static const std::regex kPlace(R"((\$L__BB|__local_depot)\d+)");
  std::uint64_t hash = fnv1a("");
  for (const Kernel* form : {&kernel, &contracted.kernel}) {
    for (const Instruction& i : form->body) {
      std::string line = std::regex_replace(text(i) + "\n", kPlace, "$1");
      for (auto at = line.find(kernel.name); at != std::string::npos; at = line.find(kernel.name)) {
        line.erase(at, kernel.name.size());
      }
      hash = fnv1a(line, hash);
    }
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace graze::cuda::twin
