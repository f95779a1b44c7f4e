// SPDX-License-Identifier: Apache-2.0
// A hash of a subject's code. It covers the bytes that are compiled or run, but not the source's file name.
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

// The device, inode, size and times of a file, which change when the file is written or replaced. Zeros without a file.
using FileState = std::array<std::int64_t, 7>;
FileState state_of(const std::filesystem::path& file);

// Whether this is a regular file; false if the system cannot tell.
bool is_file(const std::filesystem::path& file);

// A file that was read for a hash.
struct HashedFile {
  std::filesystem::path file;
  std::uint64_t hash;
  FileState state;           // before the file was read
  std::string program = {};  // the name that the PATH resolves to the file; empty if the command gives a path
};

struct CodeHash {
  std::uint64_t hash = 0;
  std::string not_covered;             // inputs of the code that the hash does not cover, in words; may be empty
  std::vector<HashedFile> files = {};  // of a command
};

// Checks that the files still have the hashed content. A file that was changed and changed back counts as unchanged.
// Throws: std::runtime_error that names a file whose content has changed, or in whose place the PATH finds another.
void expect_unchanged(const std::vector<HashedFile>& files);

// Returns: the file's bytes.   Throws: std::runtime_error if there is no such file or it is larger than 1 GiB; Stopped.
std::string code_in(const std::filesystem::path& file);
std::uint64_t hash_of_file(const std::filesystem::path& file);

// Hash of the command's text, of the program that it starts, and of the files that it names literally. Omits files that
// the shell writes to (> FILE). Does not expand variables or patterns.
CodeHash hash_of_command(const std::string& command);

// Continues the hash with a compiler's flags and the files that they name. `not_covered` describes other files that the
// flags may bring in.
CodeHash hash_of_flags(const std::vector<std::string>& flags, std::uint64_t hash);

// A build of a source, in a variant or by a toolchain.
struct Built {
  std::filesystem::path file;                 // its name is the hash of the inputs of the build
  std::string not_covered;                    // inputs that the hash does not cover, in words
  std::shared_ptr<const SealedCopy> content;  // the file's bytes as built or verified
  std::string compiler = {};                  // the first line of its --version
};

CodeHash hash_of_builds(const std::vector<Built>& built);

// Hash of the PTX of all variants, without line information.
CodeHash hash_of_ptx(const std::vector<std::string_view>& variants);

}  // namespace graze::subjects
