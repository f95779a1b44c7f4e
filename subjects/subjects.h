// SPDX-License-Identifier: Apache-2.0
// Adds foreign code as lanes, for --subject NAME=WHAT.
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
//   FILE.cpp[:FUNCTION]    a C++ source or header (also .cc, .cxx, .h, .hpp, .hxx, .hh) or FILE.c: built for each host
//                          variant
//   FILE.cu[:FUNCTION]     a CUDA source with a __device__ function: NVRTC builds it for each device variant. The
//                          build runs on a device or as a twin. A __host__ __device__ function is built for host
//                          variants too.
//   FILE.cl[:FUNCTION]     a source in OpenCL C: the device's driver builds it in four modes of its compiler
//   cmd:COMMAND            a program that answers line by line
//   published              the published algorithm of this name, only for toolchains
struct Wanted {
  std::string name, what;
  std::vector<std::string> flags;          // compiler flags, after ours
  double timeout = 1;                      // seconds
  std::uint64_t memory = 1024;             // MiB
  std::vector<std::string> builds = {};    // for a C or C++ source: cached builds to load (kept_build)
  std::vector<Toolchain> toolchains = {};  // toolchains that also compile the source
};

// Splits NAME=WHAT; a file's path becomes absolute.   Throws: UsageError.
Wanted parse_subject(const std::string& text);

// Adds the subject's lanes to the lane table. If a subject with the same name and content is open, adds only missing
// lanes of toolchains.   on_device: run CUDA code on the device, not as its twin.
// Throws: UsageError for a name that is taken; std::runtime_error with one line if the code cannot be loaded.
void open(const Wanted& wanted, bool on_device = false);

// A campaign's record of the subjects of these lanes, from which they can be opened again: [{"name", "what", "flags",
// "timeout", "memory", "hash", "source_hash", "compiler", "environment", "builds", "toolchains", "not_covered"}, …].
// "toolchains" has these lanes' toolchains: to_json, with "contraction" (recorded_plan), "build", "compiler", "runner".
// Only sources have "source_hash" (of the file alone) and "compiler". C and C++ sources also have "environment"
// (compiler_environment) and "builds" (the cached objects). A CUDA source has "compiler", "environment" and "builds" of
// its host compiler in "host", if one of the lanes runs on the host. "not_covered" describes the parts that the hash
// leaves out, and is absent if there are none. The record is null if no lane belongs to a subject.
nlohmann::ordered_json record(const std::vector<std::string>& lanes);

// Opens the subjects that a campaign recorded, unless they are open already.   changed: whether to refuse changed code.
// Returns: a line for each subject whose code differs from the code that the campaign ran.
// Throws: std::runtime_error if the code of a newly opened subject is missing, or has changed and is refused.
enum class Changed { refused, used };
std::vector<std::string> open_recorded(const nlohmann::ordered_json& spec, bool on_device = false,
                                       Changed changed = Changed::refused);

// Opens the code in a row of record() under another name, if it still exists: as the unchanged file or, for a C or C++
// source, as the builds that ran.   Returns: whether the code exists.   Throws: Stopped; UsageError for a name that is
// taken.
bool open_kept(const nlohmann::ordered_json& row, const std::string& name);

// How a subject was opened, so that a case can be reproduced.
struct Opened {
  Wanted wanted;
  std::string kind;  // "library", "source", "cuda", "opencl", "command", "published"
  std::filesystem::path file;
  std::string function;                                            // empty: the user named none
  std::uint64_t hash = 0;                                          // of the file, or of the command
  CodeHash code;                                                   // of all code that is compiled or run
  std::shared_ptr<const SealedCopy> content;                       // a library's or OpenCL source's hashed bytes
  Description description;                                         // of a build
  nlohmann::ordered_json made = nlohmann::ordered_json::object();  // how a source was compiled; see record()
};
// Null if no foreign subject has this name.
const Opened* opened(std::string_view subject);

// The user's flags for a host compiler. A CUDA source's flags are for NVRTC, so only -D, -U and -I are kept.
std::vector<std::string> host_flags(const Opened& source);

// Reads the file and the function from `wanted`, without adding lanes.   Throws: as open.
Opened named_by(const Wanted& wanted);

// The function for which a source is built; "intersects" if the user named none.
std::string function_of(const Opened& source);

// The builds of all opened CUDA sources, with their lanes' names.
std::vector<cuda::NamedBuild> cuda_builds();

// The file for a CUDA source's proof record. A lane whose twin the record covers reports it as evidence.
std::filesystem::path proof_file(const std::filesystem::path& source);

// The toolchain of a foreign lane; null if it has none.
const Toolchain* toolchain_of(const Lane& lane);

// The processes that run a foreign lane.   Requires: a foreign lane of the lane table.
ForeignProcesses& processes_of(const Lane& lane);

}  // namespace graze::subjects
