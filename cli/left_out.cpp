// SPDX-License-Identifier: Apache-2.0
// Stand-ins for the verbs that scripts/campaign does not build. Each stand-in ignores its arguments and prints that the
// verb is not built.
#include <algorithm>

#include "cli/commands.h"
#include "core/error.h"

namespace graze::cli {
namespace {

void add_left_out(CLI::App& app, std::string verb) {
  std::replace(verb.begin(), verb.end(), '_', '-');
  app.add_subcommand(verb, "Not in this build: run scripts/setup to build it")->prefix_command()->callback([verb] {
    throw std::runtime_error(not_in_a_campaigns_build("graze " + verb));
  });
}

}  // namespace

#define GRAZE_TASK(name)
#define GRAZE_VERB(name, build) GRAZE_VERB_##build(name)
#define GRAZE_VERB_campaign(name)
#define GRAZE_VERB_more(name) \
  void add_##name(CLI::App& app, int&) { add_left_out(app, #name); }
#include "cli/verbs.inc"

}  // namespace graze::cli
