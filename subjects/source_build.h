// SPDX-License-Identifier: Apache-2.0
// Builds a user's C or C++ source as shared objects, one for each host variant. They are cached by the hash of all
// their inputs.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/variants.h"
#include "subjects/code_hash.h"

namespace graze::subjects {

// The cache folder: $XDG_CACHE_HOME/graze, ~/.cache/graze, or a folder for temporary files.
std::filesystem::path cache_folder();

// Writes the file atomically: no reader sees an incomplete file.   Throws: std::runtime_error.
void write_atomically(const std::filesystem::path& file, std::string_view text);

// Whether the source defines a struct graze_subject.
bool source_describes_itself(const std::filesystem::path& source);

// Builds a shared object with `function` of the source, or with the source's own descriptions (see graze/subject.h).
// Compiles with the variant's flags, then `flags`. The file name is a hash of the preprocessed source, the flags, the
// files that they name, the files that the assembler reports as read, and the first line of the compiler's --version. A
// cached object is used if it is unchanged, the hash covers all its inputs, and the assembler read no files for it.
// Builds again if the files have changed since they were read for the hash.
// Returns: the shared object.
// Throws: std::runtime_error with the compiler's first error, or when the files keep changing; Stopped.
Built build_source(const std::filesystem::path& source, const std::string& function, const VariantInfo& variant,
                   const std::vector<std::string>& flags);

// The object that build_source has built and cached under this name, 16 hex digits.
// Throws: std::runtime_error if it is not there any more.
Built kept_build(const std::string& name);

// The set variables that choose the compiler of a C or C++ source, or what it reads.
std::map<std::string, std::string> compiler_environment(const std::filesystem::path& source);

}  // namespace graze::subjects
