// SPDX-License-Identifier: Apache-2.0
// What both forms of `graze tune` share: one lane against the truth (tune.cpp), and two lanes against each other
// (agree.cpp).
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "analysis/sweep.h"
#include "analysis/tuning.h"
#include "cli/commands.h"
#include "cli/results.h"

namespace graze::cli {

struct TuneOptions : DrawOptions {
  TuneOptions() : DrawOptions{0} {}  // 0: a million, or as many as the campaign `from` has
  std::vector<std::string> lanes;
  LaneOptions own_code;  // for --subject
  std::string epsilon;   // name of the constant in the user's code; empty: the obvious one
  std::string from, out;
  int threads = 0;
  int forbid = 2;
  double max_rate = 1e-6, max_other = 0.1;
  bool agree = false;
};

// `graze tune LANE LANE --agree`.   Requires: two lanes.
int agree(const TuneOptions& options);

// The pairs on which the choice is made (a tenth of --pairs, or the campaign's pairs), and those on which it is
// verified (drawn with the next seed).
struct TunePairs {
  fuzz::Json campaign;  // summary of the campaign with these `sources`; null: none
  std::vector<strata::PairSource> sources, others;
  std::string left_out;  // the scene's left_out_text

  bool in_doubles() const;  // whether some pairs are pairs of doubles
};

// Throws: what drawn() and pairs_of_campaign throw; UsageError if no pairs are left to choose on, or to verify on.
TunePairs tune_pairs(const TuneOptions& options);

// Throws: UsageError if some pairs are doubles and the lane takes only float32.
void expect_takes(const Lane& lane, const TunePairs& pairs);

// Returns the exact lane for these pairs, on the given lane's backend if possible.
const Lane& exact_on(const TunePairs& pairs, const Lane& lane);

AnyPair pair_at(const std::vector<strata::PairSource>& sources, const analysis::PairPlace& place);

// Returns the text of a file with this pair and these lanes.
std::string file_of_pair(const AnyPair& pair, const std::string& lanes);

// Returns the text of a file with a minimised pair on which both lanes keep their verdicts. Without twins, the pair is
// not minimised.
// Requires: a lane is wrong on the pair.
std::string smallest(const Lane& first, const Lane& second, const AnyPair& pair);

// Writes the results and prints their names. Removes each optional result (given with the first line of its kind) that
// an earlier run wrote but this one does not.
void write_listed(const std::filesystem::path& out, const std::vector<Result>& results,
                  std::initializer_list<Result> optional);

// Returns the "Next" line. The command checks the last result if that is a file of pairs. If a lane needs the option
// --subject, the command has it.
std::string next_command(const std::filesystem::path& out, const Result& last, const std::string& lanes);

// Returns sentences with each lane's cost per pair: host lanes on one core, CUDA lanes on the device. One sentence
// names the lanes whose cost is not measured: programs, and CUDA lanes without a device (a twin's time is not the
// lane's).
std::vector<std::string> cost_sentences(std::span<const Lane* const> lanes,
                                        const std::vector<strata::PairSource>& sources);

// With --from: throws UsageError if the campaign did not run the lane; std::runtime_error unless the lane's errors are
// those that the campaign counted.
void expect_errors_of(const std::string& directory, const fuzz::Json& campaign, const analysis::TuneSpec& spec,
                      const std::string& lane);

// Returns the text of changes.csv, for --from. The file covers the pairs on which the tolerance was chosen, with a row
// for each pair on which the lane is wrong without a tolerance ("wrong"), and for each pair that the best tolerance of
// a curve fixes or breaks. own_code: the decider under a policy if the lane is a user's code; else null.
inline constexpr const char* kChangesHeader = "stratum,seed,index,truth,tolerance,change\n";
std::string changes_csv(const Lane& lane, const analysis::DecideUnder& own_code, const analysis::TuneSpec& spec,
                        const analysis::Tuned& tuned, std::uint64_t seed, int threads);

}  // namespace graze::cli
