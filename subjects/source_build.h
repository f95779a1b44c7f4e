// SPDX-License-Identifier: Apache-2.0
// Builds a user's C or C++ source, or a CUDA source whose function is __host__ __device__: as a shared object for a
// host variant, or as a program for a toolchain. Builds are cached by a hash of all their inputs.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/variants.h"
#include "subjects/code_hash.h"
#include "subjects/toolchains/toolchains.h"

namespace graze::subjects {

// The cache folder: $XDG_CACHE_HOME/graze, else ~/.cache/graze, else a folder for temporary files.
std::filesystem::path cache_folder();

// Writes the file atomically: no reader sees an incomplete file.   Throws: std::runtime_error.
void write_atomically(const std::filesystem::path& file, std::string_view text);

// Writes the file atomically, unless it has this text already.   Throws: std::runtime_error; Stopped.
void write_if_new(const std::filesystem::path& file, std::string_view text);

// The first line of a program's output that contains one of these words, else its first line; empty without output.
std::string line_with(const std::string& output, std::initializer_list<std::string_view> words);

// Whether the source defines a struct graze_subject.
bool source_describes_itself(const std::filesystem::path& source);

// How a source is compiled.
struct Recipe {
  std::string compiler;     // with its flags: "aarch64-linux-gnu-g++ -O2 -static"
  std::string fixed;        // flags that all recipes of this kind share
  std::string flags;        // further flags
  bool is_program = false;  // build a program with graze/program.h, not a shared object
  bool is_kernel = false;   // compile a HIP kernel, only for its assembly
};
Recipe recipe_of(const VariantInfo& variant, const std::filesystem::path& source);
Recipe recipe_of(const Toolchain& toolchain, const std::filesystem::path& source);

// Whether a CUDA source declares the function as __host__ __device__, directly or through a macro. If the host's
// preprocessor cannot read the whole source, macros do not count.   Throws: std::runtime_error; Stopped.
bool is_host_device(const std::filesystem::path& source, const std::string& function, const Recipe& recipe,
                    const std::vector<std::string>& flags);

// Builds the source into a shared object or a program with the given `function`, or with the functions that the source
// itself describes (see graze/subject.h). Compiles with the recipe's flags, then `flags`. The file name is a hash of
// the inputs: the preprocessed source, the flags, the files that they name, the files that the assembler reports as
// read, the compiler's version, and its parts. Uses a cached object if it is unchanged, the hash covers all its inputs,
// and the assembler read no files for it. Builds again if a file has changed since it was hashed. Throws:
// std::runtime_error with the compiler's first error, or if the files keep changing; Stopped.
Built build_source(const std::filesystem::path& source, const std::string& function, const Recipe& recipe,
                   const std::vector<std::string>& flags);

// The compiler's assembly, with line information, for the code that build_source builds; see toolchains/assembly.h.
// Throws: std::runtime_error with the compiler's first error; Stopped.
std::string assembly_of(const std::filesystem::path& source, const std::string& function, const Recipe& recipe,
                        const std::vector<std::string>& flags);

// Assembles and links the result of assembly_of. The build is not cached.   Throws: as assembly_of.
Built build_assembly(std::string_view assembly, const Recipe& recipe, const std::vector<std::string>& flags);

// The build that build_source cached under this name of 16 hex digits.
// Throws: std::runtime_error if the build is no longer in the cache.
Built kept_build(const std::string& name, bool is_program = false);

// The environment variables that are set and that affect which compiler builds a C or C++ source, and which files it
// reads.
std::map<std::string, std::string> compiler_environment(const std::filesystem::path& source);

}  // namespace graze::subjects
