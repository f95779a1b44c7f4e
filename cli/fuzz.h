// SPDX-License-Identifier: Apache-2.0
// The options of `graze fuzz`, and its steps, which other verbs also use. Implemented in fuzz.cpp.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "fuzz/campaign/campaign.h"
#include "strata/scene/sources.h"

namespace graze::cli {

struct FuzzOptions : DrawOptions {
  int threads = 0;
  std::string out = "campaign";
  std::vector<std::string> mesh;
  LaneOptions lanes;
  fuzz::EngineChoice engine = fuzz::EngineChoice::automatic;
  bool by_exact_lane = false, exact_input = false;
  bool json = false;
  bool require_device = false;
  bool discard_damaged = false;
  std::optional<std::uint64_t> fail_above;
  std::string junit;  // a file; empty for none
  fuzz::Shard shard;
  std::string scratch;
};

// Returns the lanes that --lanes selects. With --subject, the exact lane runs as well, unless a pattern leaves it out.
// Throws: what selected_lanes throws.
fuzz::SelectedLanes lanes_of_campaign(const FuzzOptions& options);

// Builds the campaign for these options. `left_out`: receives the strata that the scene cannot contain.
// Requires: `under_test` outlives the campaign.
// Throws: what drawn(), strata::read_bodies and fuzz::choose_engines throw.
fuzz::Campaign campaign_of(const FuzzOptions& options, const fuzz::SelectedLanes& under_test,
                           std::vector<strata::LeftOut>& left_out);

// Writes the finished campaign as JUnit tests to the --junit file, if there is one.   Throws: what write_result throws.
void write_junit(const FuzzOptions& options, const fuzz::SelectedLanes& under_test, const fuzz::Json& summary);

// Runs or resumes the campaign, with a live line on a terminal, until it is done or the user interrupts it.
// Throws: what fuzz::run_campaign throws.
fuzz::Outcome run_with_progress(const fuzz::Campaign& campaign);

// Prints the result of a campaign at the end of `fuzz` and `merge`, and writes its picture to `out`.
void print_campaign(const std::string& out, const fuzz::Outcome& outcome, bool json,
                    const std::vector<strata::LeftOut>& left_out = {});

// Prints the result of a shard.
void print_shard(const std::string& out, const fuzz::Json& spec, const fuzz::Json& summary, bool json);

// Returns a line for each subject whose hash omits something, such as loaded libraries; empty for none.
std::string not_covered_text(const fuzz::Json& spec);

}  // namespace graze::cli
