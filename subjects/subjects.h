// SPDX-License-Identifier: Apache-2.0
// A person's own code, or a library's, as lanes: what stands behind --subject NAME=WHAT.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cuda/subject/subject_device.h"
#include "subjects/code_hash.h"
#include "subjects/process.h"

namespace graze::subjects {

// WHAT is one of
//   FILE.so[:NAME[/f64]]   a shared object: a description (graze/subject.h), or a function
//   FILE.cpp[:FUNCTION]    a C++ source, also .cc and .cxx, or FILE.c: built for each host variant
//   FILE.cu[:FUNCTION]     a CUDA source with a __device__ function: built for each device variant by NVRTC, run on a
//                          device or by its twin
//   cmd:COMMAND            a program that answers line by line
struct Wanted {
  std::string name, what;
  std::vector<std::string> flags;  // of the compiler, after ours
  double timeout = 1;              // seconds
  std::uint64_t memory = 1024;     // MiB
};

// Splits NAME=WHAT; a file's path becomes absolute.   Throws: UsageError.
Wanted parse_subject(const std::string& text);

// Adds the subject's lanes to the lane table. Of the same name and content a second time: nothing happens.
// on_device: what runs CUDA code; its twin otherwise.
// Throws: UsageError for a name that is taken; std::runtime_error, in one line, for code that cannot be had.
void open(const Wanted& wanted, bool on_device = false);

// Of the subjects whose lanes are among these: what a campaign records, so that it can open them again: [{"name",
// "what", "flags", "timeout", "memory", "hash", "not_covered": what the hash is not of, where that is anything}, …].
// Null where there are none.
nlohmann::ordered_json record(const std::vector<std::string>& lanes);

// Opens what a campaign recorded, where it is not open yet.
// Returns: a line for each subject that was open and whose code is not what the campaign ran.
// Throws: std::runtime_error where the code of one that is opened now is not what it was, or is not there.
std::vector<std::string> open_recorded(const nlohmann::ordered_json& spec, bool on_device = false);

// How a lane's subject is had, for a person or a program that shows a case again; empty for our own.
struct Opened {
  Wanted wanted;
  std::string kind;  // "library", "source", "cuda", "command"
  std::filesystem::path file;
  std::string function;                       // empty: none named
  std::uint64_t hash = 0;                     // of the file, or of the command
  CodeHash code;                              // of all that is compiled or run
  std::shared_ptr<const SealedCopy> content;  // of a library: what the hash is of
  Description description;                    // of its first build
};
const Opened* opened(std::string_view subject);

// The builds of all opened CUDA sources, each with its lane's name.
std::vector<cuda::NamedBuild> cuda_builds();

// Where the record of a CUDA source's proof lies; lanes whose twin it holds for say so.
std::filesystem::path proof_file(const std::filesystem::path& source);
// What runs a lane of foreign code.   Requires: such a lane, of the lane table.
ForeignProcesses& processes_of(const Lane& lane);

}  // namespace graze::subjects
