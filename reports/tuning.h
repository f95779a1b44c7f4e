// SPDX-License-Identifier: Apache-2.0
// What `graze tune` found: sentences for a person, tune.json, and the curves as a picture.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/tuning.h"

namespace graze::reports {

// As tune.json says them, in the order of the enumerations.
inline constexpr std::string_view kTuneForbids[] = {"false_negative", "false_positive", "any"},
                                  kTuneResults[] = {"satisfied", "too few pairs", "not confirmed", "not satisfiable"};

// What was tuned, and for what.
struct TuneQuestion {
  std::string lane;
  analysis::Forbid forbid = analysis::Forbid::any;
  double max_rate = 0;
};

// Of each sentence the first words say what it is about. Every number in them is of the pairs that it names.
std::vector<std::string> tuning_sentences(const TuneQuestion& question, const analysis::Tuned& tuned);

nlohmann::ordered_json tuning_json(const TuneQuestion& question, const analysis::Tuned& tuned);

// An SVG of 900 x 420: false negatives and false positives against the tolerance at all sites, relative to the left,
// absolute to the right; readable on light and dark ground.
std::string tuning_figure(const TuneQuestion& question, const analysis::Tuned& tuned);

}  // namespace graze::reports
