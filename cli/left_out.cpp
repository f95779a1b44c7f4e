// SPDX-License-Identifier: Apache-2.0
// Stand-ins for the verbs that scripts/campaign does not build. Each prints that it is not built, whatever its
// arguments are.
#include "cli/commands.h"
#include "core/error.h"

namespace graze::cli {
namespace {

void add_left_out(CLI::App& app, const std::string& verb) {
  app.add_subcommand(verb, "Not in this build: run scripts/setup to build it")->prefix_command()->callback([verb] {
    throw std::runtime_error(not_in_a_campaigns_build("graze " + verb));
  });
}

}  // namespace

void add_plan(CLI::App& app, int&) { add_left_out(app, "plan"); }
void add_hunt(CLI::App& app, int&) { add_left_out(app, "hunt"); }
void add_league(CLI::App& app, int&) { add_left_out(app, "league"); }
void add_view(CLI::App& app, int&) { add_left_out(app, "view"); }
void add_dump(CLI::App& app, int&) { add_left_out(app, "dump"); }
void add_discrepancy(CLI::App& app, int&) { add_left_out(app, "discrepancy"); }
void add_invariants(CLI::App& app, int&) { add_left_out(app, "invariants"); }
void add_pareto(CLI::App& app, int&) { add_left_out(app, "pareto"); }
void add_tune(CLI::App& app, int&) { add_left_out(app, "tune"); }
void add_prove_twin(CLI::App& app, int&) { add_left_out(app, "prove-twin"); }
void add_query(CLI::App& app, int&) { add_left_out(app, "query"); }
void add_bench(CLI::App& app, int&) { add_left_out(app, "bench"); }

}  // namespace graze::cli
