// SPDX-License-Identifier: Apache-2.0
// The text of --help: verbs by task and options by group, with their defaults, wrapped to the width of the terminal.
#pragma once

#include <CLI/CLI.hpp>

namespace graze::cli {

// Sets this form of --help for the command, and for every subcommand that is added later.
void format_help(CLI::App& app);

}  // namespace graze::cli
