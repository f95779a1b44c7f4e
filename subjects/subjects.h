// SPDX-License-Identifier: Apache-2.0
// Foreign code as lanes, for --subject NAME=WHAT.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cuda/subject/subject_device.h"
#include "subjects/code_hash.h"
#include "subjects/process.h"
#include "subjects/toolchains/toolchains.h"

namespace graze::subjects {

// WHAT is one of
//   FILE.so[:NAME[/f64]]   a shared object: a description (graze/subject.h) or a function
//   FILE.cpp[:FUNCTION]    a C++ source (also .cc, .cxx) or FILE.c: built for each host variant
//   FILE.cu[:FUNCTION]     a CUDA source with a __device__ function: NVRTC builds it for each device variant; it runs
//                          on a device or as a twin; a __host__ __device__ function is built for host variants too
//   FILE.cl[:FUNCTION]     a source in OpenCL C: the device's driver builds it for each of its ways to contract
//   cmd:COMMAND            a program that answers line by line
//   published              the published algorithm of this name, only for toolchains
struct Wanted {
  std::string name, what;
  std::vector<std::string> flags;          // compiler flags, after ours
  double timeout = 1;                      // seconds
  std::uint64_t memory = 1024;             // MiB
  std::vector<std::string> builds = {};    // for a C or C++ source: those to load (kept_build), not compiled again
  std::vector<Toolchain> toolchains = {};  // which compile the source too
};

// Splits NAME=WHAT; a file's path becomes absolute.   Throws: UsageError.
Wanted parse_subject(const std::string& text);

// Adds the subject's lanes to the lane table. If the same name and content are already there, adds lanes of toolchains
// that are not there yet. on_device: run CUDA code on the device, else by its twin.
// Throws: UsageError for a name that is taken; std::runtime_error with one line when the code cannot be loaded.
void open(const Wanted& wanted, bool on_device = false);

// What a campaign records about the subjects of these lanes, so that it can open them again: [{"name", "what", "flags",
// "timeout", "memory", "hash", "source_hash", "compiler", "environment", "builds", "toolchains", "not_covered"}, …].
// "toolchains" has those of these lanes: to_json, with "contraction" (recorded_plan), "build" and "compiler". Only
// sources have "source_hash" (of the file alone) and "compiler"; C and C++ sources also have "environment"
// (compiler_environment) and "builds" (the cached objects). A CUDA source has these three for its host compiler in
// "host", if one of the lanes is the host's. "not_covered" describes the parts that the hash leaves out, and is absent
// if there are none. Null when no lane has a subject.
nlohmann::ordered_json record(const std::vector<std::string>& lanes);

// Opens the subjects that a campaign recorded and that are not open yet.   changed: what to do with code that changed.
// Returns: a line for each open subject whose code differs from what the campaign ran.
// Throws: std::runtime_error when the code of a newly opened subject is missing, or has changed and is refused.
enum class Changed { refused, used };
std::vector<std::string> open_recorded(const nlohmann::ordered_json& spec, bool on_device = false,
                                       Changed changed = Changed::refused);

// Opens the code of a row of record() under another name, if it still exists: the unchanged file or, for a C or C++
// source, the builds that ran.   Returns: whether it does.   Throws: Stopped; UsageError for a name that is taken.
bool open_kept(const nlohmann::ordered_json& row, const std::string& name);

// How a lane's subject was opened, for showing a case again; empty for our own subjects.
struct Opened {
  Wanted wanted;
  std::string kind;  // "library", "source", "cuda", "opencl", "command", "published"
  std::filesystem::path file;
  std::string function;                                            // empty: none named
  std::uint64_t hash = 0;                                          // of the file, or of the command
  CodeHash code;                                                   // of all that is compiled or run
  std::shared_ptr<const SealedCopy> content;                       // for a library: the bytes that were hashed
  Description description;                                         // of its first build
  nlohmann::ordered_json made = nlohmann::ordered_json::object();  // how a source was compiled; see record()
};
const Opened* opened(std::string_view subject);

// The user's flags for a host compiler. For a CUDA source, whose flags are NVRTC's: those that begin with -D, -U or -I.
std::vector<std::string> host_flags(const Opened& source);

// The file and the function that the text names, without lanes.   Throws: as open.
Opened named_by(const Wanted& wanted);

// The function that a source is built for.
std::string function_of(const Opened& source);

// The builds of all opened CUDA sources, with their lanes' names.
std::vector<cuda::NamedBuild> cuda_builds();

// The file for the proof record of a CUDA source. Lanes whose twin it covers report it.
std::filesystem::path proof_file(const std::filesystem::path& source);

// The toolchain of a foreign lane; null if it has none.
const Toolchain* toolchain_of(const Lane& lane);

// The processes that run a foreign lane.   Requires: a foreign lane of the lane table.
ForeignProcesses& processes_of(const Lane& lane);

}  // namespace graze::subjects
