// SPDX-License-Identifier: Apache-2.0
// A user's source, rebuilt with a change and run in processes of its own: to try another epsilon, or to find the cause
// of a wrong verdict.
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

// Why the lane's code cannot be built from another text: "it is a command, and only C, C++ and CUDA sources can be
// rebuilt". Empty if it can.
std::string why_not_rebuilt(const Lane& lane);

// A source of a user's lane, with the epsilon in it.
struct TunableSource {
  std::filesystem::path file;
  std::string text;
  SourceLanguage language;
  Epsilon epsilon;
};

// name: as for epsilon_of.
// Throws: as epsilon_of; UsageError if the code cannot be rebuilt, or if a compiler flag defines the epsilon.
TunableSource tunable_source(const Lane& lane, const std::string& name);

// The lane's code as built from the text: the same variant, flags and limits. The cache of builds keeps it.
// Requires: a lane that can be rebuilt.   Throws: as build_source and cuda::build_cuda_subject; std::runtime_error
// if the function does not take these numbers, or if CUDA code has neither a device nor a twin.
std::unique_ptr<ForeignProcesses> rebuilt(const Lane& lane, const std::string& text, Scalar scalar,
                                          const std::vector<std::string>& more_flags = {});

inline constexpr double kNegligible = 1e-36;  // a normal number in float32; comparisons with 0 keep their outcome
struct Change {
  std::vector<Epsilon> negligible = {};  // numbers to replace by this one:
  double value = kNegligible;
  std::vector<std::string> flags = {};    // further compiler flags
  bool doubles = false;                   // double replaces float
  std::optional<FusedLine> rounded = {};  // products that the compiler fuses at this line are rounded
};

// The lines of the lane's source at which its compiler fuses products into additions. Empty if it fuses none, or if
// there is no source or it has changed since it was built.   Throws: Stopped.
std::vector<FusedLine> fused_lines_of(const Lane& lane);

// Whether the lane is built from a C or C++ source whose file exists and is unchanged.
bool has_source_as_built(const Lane& lane);

// Whether the lane's source may have a small number or another epsilon. Nothing if there is no source.
std::optional<bool> may_have_epsilon(const Lane& lane);

// The small numbers in a lane's source file; none if it is missing, larger than 1 MiB, or changed since it was built.
std::vector<Epsilon> small_numbers(const Lane& lane);

// Processes of a changed build that nothing else uses. The kMostIdle that were handed back last wait to be used again;
// others end.
inline constexpr int kMostIdle = 12;  // all changes of one lane
struct HandBack {
  std::string key = {};  // of the lane and the change
  void operator()(ForeignProcesses* code) const;
};
using ChangedCode = std::unique_ptr<ForeignProcesses, HandBack>;

// The lane's code with this change, built once in the lifetime of this process. Null if the lane's source file is
// missing or changed since it was built, or if the changed source does not compile.   Thread-safe.   Throws: Stopped.
ChangedCode changed(const Lane& lane, const Change& change);

// The source with double in place of float, and functions of doubles in place of those of floats, from the line after
// its last #include on.
std::string in_doubles(std::string_view source);

// Whether that changes all of the lane's arithmetic: no file of its own is included, and no vector intrinsic is used.
bool is_all_in_doubles(const Lane& lane);

}  // namespace graze::subjects
