// SPDX-License-Identifier: Apache-2.0
// What a subject consists of, to run it in another folder or on another machine.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "subjects/subjects.h"

namespace graze::subjects {

// Names in it are relative to the folder that gets the files.
struct Portable {
  std::vector<std::pair<std::string, std::filesystem::path>> files;  // the name there, and the file here
  std::string what;                                                  // for --subject NAME=WHAT
  std::vector<std::string> flags;
  std::vector<std::string> missing;  // what it also needs, one sentence each
};

// For a source: the file, and the files that it includes from its own folder and the folders of its flags. For a
// library: the file. For a command: the files that it names, except programs of the system.
Portable portable(const Opened& subject);

}  // namespace graze::subjects
