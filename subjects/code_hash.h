// SPDX-License-Identifier: Apache-2.0
// A hash of a subject's code: of what is compiled or run, not of a file's name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace graze::subjects {

struct CodeHash {
  std::uint64_t hash = 0;
  std::string not_covered;  // what else the code depends on, in words; empty when nothing
};

// Hash of the file's bytes.   Throws: std::runtime_error when the file does not exist.
std::uint64_t hash_of_file(const std::filesystem::path& file);

CodeHash hash_of_library(const std::filesystem::path& file);

// Hash of the command's text, the program that it starts, and the files that it names literally. Files that the shell
// would find by expanding variables and patterns are not included.
CodeHash hash_of_command(const std::string& command);

// Hash of a compiler's flags and of the files that they name.
std::uint64_t hash_of_flags(const std::vector<std::string>& flags, std::uint64_t hash);

// The build of a C or C++ source in a variant.
struct Built {
  std::filesystem::path file;  // named by the hash of its inputs
  std::string not_covered;     // inputs that the hash leaves out, in words
};

CodeHash hash_of_builds(const std::vector<Built>& built);

// Hash of the PTX of each variant, without its line information.
CodeHash hash_of_ptx(const std::vector<std::string_view>& variants);

}  // namespace graze::subjects
