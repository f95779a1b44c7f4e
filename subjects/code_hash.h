// SPDX-License-Identifier: Apache-2.0
// A hash of a subject's code. It covers the bytes that are compiled or run, not file names.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "subjects/sealed_copy.h"

namespace graze::subjects {

// Device, inode, size and times of a file, which show whether it was written or replaced. Zeros if there is no file.
using FileState = std::array<std::int64_t, 7>;
FileState state_of(const std::filesystem::path& file);

// Whether it is a regular file; false if that cannot be found out.
bool is_file(const std::filesystem::path& file);

// A file that was read for a hash.
struct HashedFile {
  std::filesystem::path file;
  std::uint64_t hash;
  FileState state;           // before it was read
  std::string program = {};  // the name by which the PATH finds it; empty if the command gives its path
};

struct CodeHash {
  std::uint64_t hash = 0;
  std::string not_covered;             // what else the code depends on, in words; empty if nothing
  std::vector<HashedFile> files = {};  // of a command
};

// Throws: std::runtime_error that names the file if its content has changed since it was read, or if the PATH finds
// another file. A file that was changed and changed back counts as unchanged.
void expect_unchanged(const std::vector<HashedFile>& files);

// Returns: the file's bytes.   Throws: std::runtime_error if there is no such file or it is larger than 1 GiB; Stopped.
std::string code_in(const std::filesystem::path& file);
std::uint64_t hash_of_file(const std::filesystem::path& file);

// Hash of the command's text, the program that it starts, and the files that it names literally. Files that the shell
// writes to (> FILE) are left out. Variables and patterns are not expanded.
CodeHash hash_of_command(const std::string& command);

// Hash of a compiler's flags and the files that they name. `not_covered` describes other files that the flags may bring
// in.
CodeHash hash_of_flags(const std::vector<std::string>& flags, std::uint64_t hash);

// The build of a C or C++ source in a variant.
struct Built {
  std::filesystem::path file;                 // named by the hash of what it was made of
  std::string not_covered;                    // what else it was made of, in words
  std::shared_ptr<const SealedCopy> content;  // of the file, as it was built or verified
  std::string compiler = {};                  // the first line of its --version
};

CodeHash hash_of_builds(const std::vector<Built>& built);

// Hash of the PTX of each variant, without its line information.
CodeHash hash_of_ptx(const std::vector<std::string_view>& variants);

}  // namespace graze::subjects
