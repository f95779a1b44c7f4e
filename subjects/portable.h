// SPDX-License-Identifier: Apache-2.0
// The files and arguments that a subject needs to run in another folder or on another machine.
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
  std::vector<std::string> missing;  // one sentence for each further thing that the subject needs
};

// A source needs its own file, and the files that it includes from its own folder and the folders in its flags. A
// library is a single file. A command needs the files that it names, except the system's programs.
Portable portable(const Opened& subject);

}  // namespace graze::subjects
