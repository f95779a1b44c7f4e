// SPDX-License-Identifier: Apache-2.0
// The operands of one PTX instruction in C++: what the writers of statements share.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "cuda/twin/generator/ptx.h"

namespace graze::cuda::twin {

// "%f32" as "f32_", which is no type; "$L__BB0_3" as "L__BB0_3".
std::string identifier(std::string name);

// C++ type of a PTX type; the untyped ones count as unsigned. Empty for a type without one.
std::string cpp_type(const std::string& type);

bool one_of(const std::string& word, std::initializer_list<const char*> words);
int bytes(const std::string& type);  // of a PTX type

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

  // Operand, or any text but memory, as a value of the type.
  std::string value(std::size_t o, const std::string& type) const { return value(operand(o), type); }
  std::string value(const std::string& name, const std::string& type) const;

  // A register by its name in C++.
  std::string reg(const std::string& name) const;

  // "d = expression;" where the expression has the type; a wider register takes it extended by its sign.
  std::string assign(const std::string& destination, const std::string& type, const std::string& expression) const;
  std::string assign(const std::string& type, const std::string& expression) const {
    return assign(operand(0), type, expression);
  }

  // "[%rd1+8]" as an address.
  std::string address(const std::string& memory) const;

  // "{%r1,%r2}" one by one; anything else is alone.
  static std::vector<std::string> elements(const std::string& name);

  // The modifiers between the operation and its type must be among these.
  void only(std::initializer_list<const char*> known) const;

 private:
  const Module& module_;
  const Kernel& kernel_;
  const Instruction& instruction_;
};

}  // namespace graze::cuda::twin
