// SPDX-License-Identifier: Apache-2.0
// `graze merge`: merges shards into one campaign.
#include <fmt/format.h>

#include "cli/fuzz.h"
#include "core/text.h"
#include "fuzz/shards/merge.h"
#include "reports/terminal.h"

namespace graze::cli {
namespace {

struct MergeOptions {
  std::vector<std::string> parts;
  std::string out;
  bool partial = false, json = false;
};

int merge(const MergeOptions& options) {
  fuzz::MergeOptions wanted{{}, options.out, options.partial};
  for (const std::string& part : options.parts) {
    wanted.parts.emplace_back(part);
    if (!wanted.parts.back().has_filename()) wanted.parts.back() = wanted.parts.back().parent_path();  // "shard-1/"
  }
  const fuzz::Outcome outcome = fuzz::merge(wanted);
  const std::filesystem::path out = options.out;
  // The system rejects "b/../c" if b does not exist.
  print_campaign(std::filesystem::exists(out) ? options.out : out.lexically_normal().string(), outcome, options.json);
  if (!outcome.complete) {
    std::fflush(stdout);
    fmt::print(stderr, "graze: the campaign is not complete; `graze fuzz` with --out {} resumes it\n",
               path_word(options.out));
  }
  return 0;
}

}  // namespace

void add_merge(CLI::App& app, int& status) {
  CLI::App* command =
      app.add_subcommand("merge", "Join the shards of a campaign; the result is the same as that of one run");
  command->footer("Example: graze merge shard-* --out campaign");
  auto options = std::make_shared<MergeOptions>();
  command->add_option("DIR", options->parts, "Directories of shards, or of campaigns merged before, in any order")
      ->required();
  add_valued(*command, "--out", options->out, "DIR", "Directory for the campaign, new or empty")->required();
  command->add_flag("--partial", options->partial,
                    "Merge the existing shards into an unfinished campaign, which `graze fuzz` resumes");
  command->add_flag("--json", options->json, "Print the summary as JSON");
  command->callback([options, &status] { status = merge(*options); });
}

}  // namespace graze::cli
