// SPDX-License-Identifier: Apache-2.0
// Presents the results of `graze tune --agree`: sentences, a table, agree.json, and the curves as a picture.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analysis/agreement.h"
#include "reports/screen.h"

namespace graze::reports {

// The two compared lanes, and the goal.
struct AgreeQuestion {
  std::vector<std::string> lanes;    // two
  std::vector<std::string> rounded;  // the same lanes with every operation rounded as written; empty if `lanes` are
  std::string flag;                  // the compiler flag that gives `rounded`
  std::string without_relative;      // the lane that has no twin under relative tolerances; empty if both have one
  double max_rate = 0;
  std::string exact_scalar = "f32";  // the scalar of the lanes that decide the pairs exactly
};

// The answer first. Every number in it belongs to the pairs that the sentence names.
std::vector<std::string> agreement_sentences(const AgreeQuestion& question, const analysis::Agreed& agreed);

// The best tolerance of each curve on the fresh pairs: differing verdicts, and each lane's errors. Tolerances that
// change nothing there are left out.
std::string agreement_table(const AgreeQuestion& question, const analysis::Agreed& agreed, const Screen& screen);

nlohmann::ordered_json agreement_json(const AgreeQuestion& question, const analysis::Agreed& agreed);

// Returns an SVG of 900 x 420 like tuning_figure: differing verdicts, and each lane's wrong ones.
std::string agreement_figure(const AgreeQuestion& question, const analysis::Agreed& agreed);

}  // namespace graze::reports
