// SPDX-License-Identifier: Apache-2.0
// The code that the user gives to `graze try`, in the form that --subject takes.
#pragma once

#include <string>
#include <string_view>

namespace graze::cli {

inline constexpr std::string_view kCommand = "cmd:";

struct TriedCode {
  std::string name, what;
  bool is_program = false;
  std::string wrapper = {};  // the file that was written to call a Python function
};

// source: FILE, FILE:FUNCTION or cmd:COMMAND, with or without NAME= before it. For a Python function such as
// "mine.py:meet", writes, beside the folder `out`, the program that calls it.
// Throws: UsageError for an impossible function name, or if a foreign file has the program's name; std::runtime_error
// for a program that cannot be read.
TriedCode code_of(const std::string& source, const std::string& out);

}  // namespace graze::cli
