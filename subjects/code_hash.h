// SPDX-License-Identifier: Apache-2.0
// What a subject's code is, as a number: what is compiled or run, and not the name of a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace graze::subjects {

struct CodeHash {
  std::uint64_t hash = 0;
  std::string not_covered;  // what the code depends on beside it, in words; empty where that is nothing
};

// Of the file's bytes.   Throws: std::runtime_error where there is no such file.
std::uint64_t hash_of_file(const std::filesystem::path& file);

CodeHash hash_of_library(const std::filesystem::path& file);

// Of the command's text, the program that it starts, and the files that it names as they stand there: what a shell
// would put in for variables and patterns is not known.
CodeHash hash_of_command(const std::string& command);

// Of a compiler's flags, and of the files that they name.
std::uint64_t hash_of_flags(const std::vector<std::string>& flags, std::uint64_t hash);

// What was built of a C or C++ source in a variant.
struct Built {
  std::filesystem::path file;  // named by the hash of what it was made of
  std::string not_covered;     // what else it was made of, in words
};

CodeHash hash_of_builds(const std::vector<Built>& built);

// Of the PTX of each variant, without the places of its lines in files.
CodeHash hash_of_ptx(const std::vector<std::string_view>& variants);

}  // namespace graze::subjects
