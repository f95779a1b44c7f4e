// SPDX-License-Identifier: Apache-2.0
// PTX as the twin generator sees it: tables, and kernels and functions of parameters, registers, local memory and
// instructions. Reference: NVIDIA, PTX ISA 9.0. Of its grammar, what nvcc writes for kernels without shared memory.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace graze::cuda::twin {

// what() is one line: "FILE:LINE: why: INSTRUCTION".
struct PtxError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Place {
  int file = 0;  // number in Module::files; 0 when unknown
  int line = 0;
  int column = 0;
  friend bool operator==(const Place&, const Place&) = default;
};

// Where an instruction comes from: its source line, and the line into which that was inlined (file 0: into none).
// PTX does not say without doubt what lies further out.
struct Source {
  Place at;
  Place from;
  friend bool operator==(const Source&, const Source&) = default;
};

// A label, a directive among the instructions, or an instruction.
struct Instruction {
  std::string label = {};
  std::string directive =
      {};                  // "{", "}", ".param .b32 param0;", ".pragma …;", ".branchtargets L1, L2;" after its label
  std::string guard = {};  // "%p3", or empty
  bool guard_negated = false;
  std::vector<std::string> op = {};        // "fma", "rn", "f32"
  std::vector<std::string> operands = {};  // destination first; "[%rd1+4]" and "{%r1,%r2}" are one operand each
  int line = 0;                            // in the PTX file
  Source source = {};
  bool by_hand = false;  // an fma that the source has: no contraction
  int site = -1;         // of a contraction, in Contracted::sites

  bool is_label() const { return !label.empty(); }
  bool is_operation() const { return !op.empty(); }
  bool has(std::string_view modifier) const;
};

// An instruction as PTX spells it, without the semicolon.
std::string text(const Instruction& instruction);

struct Parameter {
  std::string declaration;  // ".param .align 8 .b8 NAME[16]"
  std::string name;
  int bytes = 0;
};

// Of a declaration ".param .b32 NAME"; nothing when it is none.
std::optional<Parameter> parameter(const std::string& declaration);

// A table in constant or global memory.
struct Table {
  std::string declaration;  // as it stands in the file, without the semicolon
  std::string name;
  int align = 0;
  std::vector<std::uint8_t> bytes;
};

// A kernel, or a function that kernels call.
struct Kernel {
  std::string name;
  int line = 0;
  bool is_function = false;
  bool declared_before = false;     // a function that is declared ahead of its definition
  std::string linkage;              // of a function: "", ".visible ", ".weak "
  std::vector<Parameter> returned;  // of a function
  std::vector<Parameter> parameters;
  std::map<std::string, std::pair<std::string, int>>
      registers;      // prefix, such as "%f", to type and count: 0 for a single register
  std::string local;  // name of the local array, or empty
  int local_align = 0;
  int local_bytes = 0;
  std::map<std::string, std::vector<std::string>> branch_targets;  // labels, by the name of their list
  std::vector<Instruction> body;
};

// Type of a register of the kernel ("f32", "pred"), or empty when it has none of that name.
std::string register_type(const Kernel& kernel, std::string_view name);

struct Module {
  std::string path;
  std::string version;  // "9.0"
  std::string target;   // "sm_75"
  std::string toolkit;  // "13.0.88", from the comment of nvcc; or empty
  std::map<int, std::string> files;
  std::vector<Table> tables;
  std::vector<Kernel> kernels;  // and functions
};

// Reads PTX. `path` stands for the stream in messages.
// Throws: PtxError for what this reader does not know; an unknown instruction is the writers' affair.
Module read_ptx(std::istream& in, const std::string& path);

}  // namespace graze::cuda::twin
