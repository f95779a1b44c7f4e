// SPDX-License-Identifier: Apache-2.0
// Presents the results of `graze tune --agree`: sentences, a table, agree.json, and the curves as a picture.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analysis/agreement.h"
#include "reports/screen.h"

namespace graze::reports {

// The question of `graze tune --agree`: the two lanes to compare, and the goal.
struct AgreeQuestion {
  std::vector<std::string> lanes;    // exactly two
  std::vector<std::string> rounded;  // the same lanes, rounded as written; empty if `lanes` already are
  std::string flag;                  // the compiler flag that builds `rounded`
  std::string without_relative;      // the lane without a twin under relative tolerances; empty if both have one
  double max_rate = 0;
  std::string exact_scalar = "f32";  // the scalar of the exact lanes
};

// Returns the results as sentences, the answer first. Each sentence names the pairs that its numbers describe.
std::vector<std::string> agreement_sentences(const AgreeQuestion& question, const analysis::Agreed& agreed);

// Returns a table of the best tolerance of each curve: how many verdicts differ on the fresh pairs, and how often each
// lane is wrong there. Tolerances that change no verdict are left out.
std::string agreement_table(const AgreeQuestion& question, const analysis::Agreed& agreed, const Screen& screen);

nlohmann::ordered_json agreement_json(const AgreeQuestion& question, const analysis::Agreed& agreed);

// Returns an SVG of 900 x 420, like tuning_figure, with the shares of differing verdicts and of each lane's errors.
std::string agreement_figure(const AgreeQuestion& question, const analysis::Agreed& agreed);

}  // namespace graze::reports
