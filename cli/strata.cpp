// SPDX-License-Identifier: Apache-2.0
// `graze strata`: prints the table of strata from the code.
#include "strata/strata.h"

#include <fmt/format.h>
#include <unistd.h>

#include <iterator>
#include <limits>

#include "cli/commands.h"
#include "cli/screen.h"
#include "strata/groups.h"

namespace graze::cli {

void add_strata(CLI::App& app, int&) {
  CLI::App* command =
      app.add_subcommand("strata", "List the strata, the named generators of pairs, each with its group");
  command->footer("Example: graze strata");
  command->callback([] {
    // Programs that read the list get one line for each stratum.
    const int columns = isatty(STDOUT_FILENO) ? output_screen().columns : std::numeric_limits<int>::max();
    const auto print = [&](const strata::StratumInfo& row) {
      fmt::print("{}", reports::wrapped(fmt::format("{:<20} {:<11} {}", row.id,
                                                    strata::kGroups[static_cast<int>(row.group)].id, row.what),
                                        columns, 0, 33));
    };
    for (const strata::StratumInfo& row : strata::kStrata) print(row);
    fmt::print("\n--coordinates f64 draws all of these in doubles. New or different there:\n");
    for (std::size_t i = 0; i < std::size(strata::kDoubleStrata); ++i) {
      const strata::StratumInfo& row = strata::kDoubleStrata[i];
      if (i >= std::size(strata::kStrata) || row.what != strata::kStrata[i].what) print(row);
    }
    fmt::print("\nNext: graze fuzz --strata 'near_*'\n");
  });
}

}  // namespace graze::cli
