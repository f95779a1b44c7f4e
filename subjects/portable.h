// SPDX-License-Identifier: Apache-2.0
// The files and the arguments with which a subject runs in another folder or on another machine.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "subjects/subjects.h"

namespace graze::subjects {

// All names are relative to the folder that gets the files.
struct Portable {
  std::vector<std::pair<std::string, std::filesystem::path>> files;  // each name in that folder, and the file here
  std::string what;                                                  // for --subject NAME=WHAT
  std::vector<std::string> flags;
  std::vector<std::string> missing;  // one sentence for each thing that the subject also needs
};

// The files of a source are the source, and the files that it includes from its own folder and from the folders of its
// flags. A library has one file. The files of a command are those that it names, except programs of the system.
Portable portable(const Opened& subject);

}  // namespace graze::subjects
