// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace graze::subjects {

// The command that runs the program in the file: `run` with the file in place of each {}, else at the end.
inline std::string command_of(const std::string& run, const std::string& file) {
  if (run.empty()) return file;
  if (run.find("{}") == run.npos) return run + ' ' + file;
  std::string command = run;
  for (std::size_t at = command.find("{}"); at != command.npos; at = command.find("{}", at + file.size()))
    command.replace(at, 2, file);
  return command;
}

}  // namespace graze::subjects
