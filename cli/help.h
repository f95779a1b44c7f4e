// SPDX-License-Identifier: Apache-2.0
// The text of --help: verbs by task, options by group, each with its default, in the columns of the terminal.
#pragma once

#include <CLI/CLI.hpp>

namespace graze::cli {

// Sets this form of --help for the command, and for every subcommand that is added from now on.
void format_help(CLI::App& app);

}  // namespace graze::cli
