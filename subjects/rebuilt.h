// SPDX-License-Identifier: Apache-2.0
// Rebuilds a user's source with a change, and runs the build in separate processes, to try another epsilon or to show
// the cause of a wrong verdict.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"
#include "subjects/epsilon.h"
#include "subjects/process.h"
#include "subjects/toolchains/assembly.h"

namespace graze::subjects {

// Why the lane's code cannot be rebuilt, such as "it is a command, and only C, C++ and CUDA sources can be rebuilt".
// Empty if it can.
std::string why_not_rebuilt(const Lane& lane);

// The source of a user's lane, and the epsilon in it.
struct TunableSource {
  std::filesystem::path file;
  std::string text;
  SourceLanguage language;
  Epsilon epsilon;
};

// name: as for epsilon_of.
// Throws: as epsilon_of; UsageError if the code cannot be rebuilt, or if a compiler flag defines the epsilon.
TunableSource tunable_source(const Lane& lane, const std::string& name);

// The lane's code, built from the text with the lane's variant, flags and limits. The build is cached.
// Requires: a lane that can be rebuilt.   Throws: as build_source and cuda::build_cuda_subject; std::runtime_error
// if the function does not take these numbers, or if CUDA code has neither a device nor a twin.
std::unique_ptr<ForeignProcesses> rebuilt(const Lane& lane, const std::string& text, Scalar scalar,
                                          const std::vector<std::string>& more_flags = {});

// The number that replaces an epsilon. This number is normal in float32. It is positive, so a comparison of 0 with it
// has the same outcome as with the epsilon.
inline constexpr double kNegligible = 1e-36;
// In the notation of the numbers, which decides its type: "1e-36f". Without a suffix if they have different ones.
std::string negligible_in_words(const std::vector<Epsilon>& numbers);
struct Change {
  std::vector<Epsilon> negligible = {};  // `value` replaces these numbers
  double value = kNegligible;
  std::vector<std::string> flags = {};    // further compiler flags
  bool doubles = false;                   // double replaces float
  std::optional<FusedLine> rounded = {};  // the line whose fused products are rounded
};

// The lines of the lane's source at which its compiler fuses products into additions. Empty if there are none, if there
// is no source, or if the source has changed since it was built.   Throws: Stopped.
std::vector<FusedLine> fused_lines_of(const Lane& lane);

// Whether one of the source_files of the lane's subject uses something that depends on the build, such as __FMA__ or
// sizeof; also true if some of these files are not found or are too large. If so, a build with other flags or types may
// contain different code, whose verdicts show nothing about the lane's code.
bool selects_by_build(const Lane& lane);

// Whether the lane is built from a C or C++ source whose file exists and is unchanged.
bool has_source_as_built(const Lane& lane);

// Whether the lane's source may have an epsilon, as a small number or a named constant; nothing if no source can be
// read.
std::optional<bool> may_have_epsilon(const Lane& lane);

// The small numbers in a lane's source file. None if the file is missing, changed, or larger than 1 MiB.
std::vector<Epsilon> small_numbers(const Lane& lane);

// The processes of a changed build, for one user at a time. HandBack hands them back. The last kMostIdle processes that
// were handed back wait for the next user; older ones end.
inline constexpr int kMostIdle = 12;  // enough for all changes of one lane
struct HandBack {
  std::string key = {};  // identifies the lane and the change
  void operator()(ForeignProcesses* code) const;
};
using ChangedCode = std::unique_ptr<ForeignProcesses, HandBack>;

// The lane's code with this change, built at most once per process. Null if the lane's source file is missing or has
// changed since it was built, or if the changed source does not compile.
// Thread-safe.   Throws: Stopped.
ChangedCode changed(const Lane& lane, const Change& change);

// The source with double in place of float, and with the functions for double in place of those for float. Lines up to
// the last #include stay unchanged.
std::string in_doubles(std::string_view source);

// Whether in_doubles changes all arithmetic: the source includes no file in quotes, and uses no vector intrinsic.
bool is_all_in_doubles(const Lane& lane);

}  // namespace graze::subjects
