// SPDX-License-Identifier: Apache-2.0
// Reads contractions from a compiler's assembly: the source lines at which products are fused into additions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace graze::subjects {

// A source line, and the fused operations that the compiler made from it: "madd f32 x2, msub f64".
struct FusedLine {
  std::string file;  // relative to the source's folder, if the file is in it
  int line;
  std::string operations;
  int count = 0;          // number of operations
  std::string code = {};  // the line's text, if read_code has read it
  std::string place() const { return file + ':' + std::to_string(line); }
  friend bool operator==(const FusedLine&, const FusedLine&) = default;
};

// The fused lines of an assembly with line information (-g1), by file and line. Reads code for x86-64 (AT&T syntax),
// ARM64, RISC-V, Power, and AMD's GPUs.   folder: the folder of the source.   numbers: "f32" or "f64", to read only the
// operations on these numbers.
std::vector<FusedLine> fused_lines(std::string_view assembly, const std::filesystem::path& folder,
                                   std::string_view numbers = "");

// Why no plan can be read from assembly for this processor, in words; empty if one can.
// target: the output of the compiler's -dumpmachine.
std::string why_not_read(std::string_view target);

// Reads the code of each line whose file exists.   folder: the folder of the source.
void read_code(std::vector<FusedLine>& plan, const std::filesystem::path& folder);

// A hash of each line's code and operations. Moving a line does not change the hash. If the code was not read, the
// line's number takes its place. For an absolute path, only the file name counts, because folders differ between
// machines.
std::uint64_t plan_hash(const std::vector<FusedLine>& plan);

// The number of fused operations on all lines.
int operations_of(const std::vector<FusedLine>& plan);

// A contraction plan in one line: "14 fused operations on 9 lines, plan 3f2a7b1c5d6e7f80".
std::string plan_in_words(const std::vector<FusedLine>& plan);

// {"plan": "3f2a7b1c5d6e7f80", "operations": 14, "lines": [{"place": "a.h:12", "operations": "madd f32 x2"}, …]}
nlohmann::ordered_json plan_json(const std::vector<FusedLine>& plan);

// The assembly with each fused operation of that line split into a rounded product and a sum. Other lines stay
// unchanged.   Returns: nothing if an operation of the line cannot be split, or if the assembly is for a processor
// other than x86-64 and ARM64.
std::optional<std::string> with_rounded_products(std::string_view assembly, const std::filesystem::path& folder,
                                                 const FusedLine& line);

}  // namespace graze::subjects
