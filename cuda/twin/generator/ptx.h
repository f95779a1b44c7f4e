// SPDX-License-Identifier: Apache-2.0
// PTX for the twin generator: tables, kernels and functions with their parameters, registers, local memory and
// instructions. The reader supports the grammar that nvcc writes for kernels without shared memory. Reference: NVIDIA,
// PTX ISA 9.0.
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
  int file = 0;  // index in Module::files; 0 when unknown
  int line = 0;
  int column = 0;
  friend bool operator==(const Place&, const Place&) = default;
};

// An instruction's origin: its source line, and the line into which it was inlined (file 0: not inlined). PTX does not
// reliably identify further levels of inlining.
struct Source {
  Place at;
  Place from;
  friend bool operator==(const Source&, const Source&) = default;
};

// A label, an instruction, or a directive among the instructions.
struct Instruction {
  std::string label = {};
  std::string directive =
      {};                  // "{", "}", ".param .b32 param0;", ".pragma …;", ".branchtargets L1, L2;" after its label
  std::string guard = {};  // "%p3", or empty
  bool guard_negated = false;
  std::vector<std::string> op = {};        // "fma", "rn", "f32"
  std::vector<std::string> operands = {};  // destination first; "[%rd1+4]" and "{%r1,%r2}" are one operand each
  int line = 0;                            // line in the PTX file
  Source source = {};
  bool by_hand = false;  // an fma that the source contains, so not a contraction
  int site = -1;         // the index in Contracted::sites if the instruction is a contraction

  bool is_label() const { return !label.empty(); }
  bool is_operation() const { return !op.empty(); }
  bool has(std::string_view modifier) const;
};

// The instruction in PTX syntax, without the semicolon.
std::string text(const Instruction& instruction);

struct Parameter {
  std::string declaration;  // ".param .align 8 .b8 NAME[16]"
  std::string name;
  int bytes = 0;
};

// Parses a declaration such as ".param .b32 NAME".   Returns: nullopt for any other text.
std::optional<Parameter> parameter(const std::string& declaration);

// A table in constant or global memory.
struct Table {
  std::string declaration;  // as in the file, without the semicolon
  std::string name;
  int align = 0;
  std::vector<std::uint8_t> bytes;
};

// A kernel, or a function that kernels call.
struct Kernel {
  std::string name;
  int line = 0;
  bool is_function = false;
  bool declared_before = false;     // a function that is declared before its definition
  std::string linkage;              // a function's: "", ".visible ", ".weak "
  std::vector<Parameter> returned;  // a function's result
  std::vector<Parameter> parameters;
  std::map<std::string, std::pair<std::string, int>>
      registers;      // prefix, such as "%f", to type and count; a count of 0 means a single register
  std::string local;  // name of the local array, or empty
  int local_align = 0;
  int local_bytes = 0;
  std::map<std::string, std::vector<std::string>> branch_targets;  // lists of labels, by the name of the list
  std::vector<Instruction> body;
};

// The type of a register of the kernel ("f32", "pred"); empty if the kernel has no register with that name.
std::string register_type(const Kernel& kernel, std::string_view name);

struct Module {
  std::string path;
  std::string version;  // "9.0"
  std::string target;   // "sm_75"
  std::string toolkit;  // "13.0.88", from nvcc's comment; may be empty
  std::map<int, std::string> files;
  std::vector<Table> tables;
  std::vector<Kernel> kernels;  // kernels and functions
};

// Reads PTX. Messages name the stream `path`. The reader accepts unknown instructions; the writers reject them.
// Throws: PtxError for syntax that the reader does not support.
Module read_ptx(std::istream& in, const std::string& path);

}  // namespace graze::cuda::twin
