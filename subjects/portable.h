// SPDX-License-Identifier: Apache-2.0
// The files and arguments that a subject needs to run in another folder or on another machine.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "subjects/subjects.h"

namespace graze::subjects {

// The files of a subject that is a source: its own, those in its flags, and all that they include from their own
// folders and from the folders in the flags.   Throws: std::runtime_error if a file cannot be read.
struct SourceFiles {
  std::set<std::filesystem::path> files;
  bool whole = true;  // false: a file that is included in quotes is in none of these folders
};
SourceFiles source_files(const Opened& subject);

// All names are relative to the folder that gets the files.
struct Portable {
  std::vector<std::pair<std::string, std::filesystem::path>> files;  // each name in that folder, and the file here
  std::string what;                                                  // for --subject NAME=WHAT
  std::vector<std::string> flags;
  std::vector<std::string> missing;  // one sentence for each further thing that the subject needs
};

// A source needs its source_files. A library is a single file. A command needs the files that it names, except the
// system's programs.
Portable portable(const Opened& subject);

}  // namespace graze::subjects
