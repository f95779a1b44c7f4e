// SPDX-License-Identifier: Apache-2.0
// One PTX instruction's operands as C++ expressions, and the functions that write statements with them.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {

// "%f32" becomes "f32_", because f32 is a type. "$L__BB0_3" becomes "L__BB0_3".
std::string identifier(std::string name);

// The C++ type of a PTX type; types of untyped bits (b32) become unsigned (u32). Empty if there is none.
std::string cpp_type(const std::string& type);

bool one_of(const std::string& word, std::initializer_list<const char*> words);
int bytes(const std::string& type);  // the size of a PTX type

class Operands {
 public:
  Operands(const Module& module, const Kernel& kernel, const Instruction& instruction)
      : module_(module), kernel_(kernel), instruction_(instruction) {}

  // Throws: PtxError with the instruction and its line.
  [[noreturn]] void fail(const std::string& why) const;

  const Module& module() const { return module_; }
  const Kernel& kernel() const { return kernel_; }
  const Instruction& instruction() const { return instruction_; }
  const std::string& type() const { return instruction_.op.back(); }
  std::size_t count() const { return instruction_.operands.size(); }
  const std::string& operand(std::size_t o) const;

  // An operand, given by index or text, as a value of this type.   Requires: not a memory operand.
  std::string value(std::size_t o, const std::string& type) const { return value(operand(o), type); }
  std::string value(const std::string& name, const std::string& type) const;

  // The C++ name of a register.
  std::string reg(const std::string& name) const;

  // "d = expression;" for an expression of this type. For a wider register, the value is extended as its type requires.
  std::string assign(const std::string& destination, const std::string& type, const std::string& expression) const;
  std::string assign(const std::string& type, const std::string& expression) const {
    return assign(operand(0), type, expression);
  }

  // The address in "[%rd1+8]".
  std::string address(const std::string& memory) const;

  // The elements of a list such as "{%r1,%r2}"; any other operand is returned as the only element.
  static std::vector<std::string> elements(const std::string& name);

  // Throws: PtxError if a modifier between the operation and its type is not in the list.
  void only(std::initializer_list<const char*> known) const;

 private:
  const Module& module_;
  const Kernel& kernel_;
  const Instruction& instruction_;
};

// Writes PTX arithmetic as C++ statements that call the functions of cuda/twin/twin_ops*.h.
// Throws: PtxError for an instruction that is unknown or cannot be replayed.
std::string floating_statement(const Operands& operands);
std::string integer_statement(const Operands& operands);

// One PTX instruction as a statement of the function `run`, which calls the functions of cuda/twin/twin_ops.h; see
// cpp_writer.h.   Requires: not a label.   Throws: PtxError for an instruction that is unknown or cannot be replayed.
std::string cpp_statement(const Module& module, const Kernel& kernel, const Instruction& instruction);

}  // namespace graze::cuda::twin
