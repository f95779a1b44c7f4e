// SPDX-License-Identifier: Apache-2.0
// Presents the results of `graze tune` as sentences, tune.json, and a picture of the curves.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/tuning.h"
#include "reports/screen.h"
#include "subjects/rebuilt.h"

namespace graze::reports {

// The words in tune.json, in the order of the enumerations.
inline constexpr std::string_view kTuneForbids[] = {"false_negative", "false_positive", "any"},
                                  kTuneResults[] = {"satisfied", "too few pairs", "not confirmed", "not satisfiable",
                                                    "not useful"};

// The names that tune.json gives to a choice that changes nothing: no tolerance, or a user's epsilon as it is.
inline constexpr std::string_view kZero = "zero", kAsItIs = "as it is";

// The tuned lane, and the goal of the tuning.
struct TuneQuestion {
  std::string lane;
  analysis::Forbid forbid = analysis::Forbid::any;
  double max_rate = 0, max_other = 0;
  const subjects::TunableSource* source = nullptr;  // for a user's code: the source with the epsilon
  std::string units = {};                           // unit of the scene's coordinates; empty without a scene
};

// Each sentence starts with its topic and names the pairs that its numbers describe.
std::vector<std::string> tuning_sentences(const TuneQuestion& question, const analysis::Tuned& tuned);

// Returns a table of the best tolerance of each curve. It counts the verdicts that the tolerance fixes, breaks or
// leaves wrong on the pairs used to choose. Tolerances that change no verdict on these pairs are left out.
std::string tuning_table(const TuneQuestion& question, const analysis::Tuned& tuned, const Screen& screen);

nlohmann::ordered_json tuning_json(const TuneQuestion& question, const analysis::Tuned& tuned);

// Returns an SVG of 900 x 420: false negatives and false positives against the tolerance at all sites. Relative
// tolerances are on the left, absolute ones on the right. Readable on light and dark backgrounds.
std::string tuning_figure(const TuneQuestion& question, const analysis::Tuned& tuned);

}  // namespace graze::reports
