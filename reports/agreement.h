// SPDX-License-Identifier: Apache-2.0
// Presents the results of `graze tune --agree`: sentences, a table, agree.json, and the curves as a picture.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analysis/agreement.h"
#include "reports/screen.h"

namespace graze::reports {

// The lanes that are compared, and the goal.
struct AgreeQuestion {
  std::vector<std::string> lanes;    // two
  std::vector<std::string> rounded;  // with all operations rounded as written; empty if the lanes are these
  std::string flag;                  // of the compiler, that makes them so
  std::string without_relative;      // the lane that has no twin under relative tolerances; empty: both have one
  double max_rate = 0;
  std::string exact_scalar = "f32";  // of the lanes that decide the pairs exactly
};

// The answer first. Every number in it belongs to the pairs that the sentence names.
std::vector<std::string> agreement_sentences(const AgreeQuestion& question, const analysis::Agreed& agreed);

// The best tolerance of each curve on the fresh pairs: differing verdicts, and each lane's errors. Tolerances that
// change nothing there are left out.
std::string agreement_table(const AgreeQuestion& question, const analysis::Agreed& agreed, const Screen& screen);

nlohmann::ordered_json agreement_json(const AgreeQuestion& question, const analysis::Agreed& agreed);

// Returns an SVG of 900 x 420 as tuning_figure does: differing verdicts, and wrong ones of each lane.
std::string agreement_figure(const AgreeQuestion& question, const analysis::Agreed& agreed);

}  // namespace graze::reports
