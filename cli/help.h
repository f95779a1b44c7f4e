// SPDX-License-Identifier: Apache-2.0
// The text of --help: verbs by task, options by group, each with its default, in the columns of the terminal.
#pragma once

#include <CLI/CLI.hpp>

namespace graze::cli {

// Gives the command and every subcommand that is added from now on this form of --help.
void format_help(CLI::App& app);

}  // namespace graze::cli
