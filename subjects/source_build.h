// SPDX-License-Identifier: Apache-2.0
// Shared objects from a user's C or C++ source, one for each host variant, kept by the hash of all that they are made
// of.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/variants.h"
#include "subjects/code_hash.h"

namespace graze::subjects {

// Where what was built is kept: $XDG_CACHE_HOME/graze, or ~/.cache/graze, or a folder for temporary files.
std::filesystem::path cache_folder();

// Writes the file in one step: nobody sees a part of it.   Throws: std::runtime_error.
void write_atomically(const std::filesystem::path& file, std::string_view text);

// Whether the source has a struct graze_subject of its own.
bool source_describes_itself(const std::filesystem::path& source);

// Returns: the shared object's file, named by the hash of the preprocessed source, the flags, the files that they name,
// those that the assembler says it read, and the compiler's first line of --version. It is built if it is not there as
// it was built before, and always where that hash does not cover all that it is made of. It has `function` of the
// source, or the descriptions that the source makes itself (see graze/subject.h), with the variant's flags and then
// `flags`. Throws: std::runtime_error with the compiler's first error; Stopped.
Built build_source(const std::filesystem::path& source, const std::string& function, const VariantInfo& variant,
                   const std::vector<std::string>& flags);

}  // namespace graze::subjects
