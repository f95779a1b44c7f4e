// SPDX-License-Identifier: Apache-2.0
// The answer that `graze try` gives about a user's code, on one screen and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "analysis/pareto.h"
#include "cli/tried_code.h"
#include "fuzz/selected_lanes.h"
#include "reports/own_code.h"
#include "reports/screen.h"
#include "strata/scene/sources.h"

namespace graze::cli {

inline constexpr std::uint64_t kPairsOfProgram = 2'000;  // for a program, which answers each pair with a line of text

// The cost of a call that decides one pair.
struct CallCosts {
  struct Row {
    const Lane* lane = nullptr;
    std::optional<analysis::Cost> cost = {};
    std::string why_not = {};  // why there is no cost
  };
  Row own, exact, cheapest;  // cheapest: of the published lanes
  std::size_t pairs = 0;     // number of timed pairs
};

// Times the lane of the code, the exact lane, and the published lane that costs least, on the first pairs of the
// sources.
CallCosts call_costs(const Lane& own, const std::vector<strata::PairSource>& sources);

// The epsilon in the code's source.
struct OwnEpsilon {
  std::string named;    // "1e-6f at mine.cpp:9", "kEps = 1e-6f at mine.cpp:3 or 1e-9f at mine.cpp:7"; empty: none found
  std::string tune;     // the command that tunes it; empty if `graze tune` would refuse it
  std::string why_not;  // a sentence: why Graze cannot change it; empty if it can, or if none was found
};
// If several numbers may be the epsilon, `tune` names the one whose replacement by a negligible number mends most
// pairs.
// is_wrong: whether the code is wrong on some of these pairs.
OwnEpsilon epsilon_of_code(const Lane& own, const std::vector<strata::PairSource>& sources, bool is_wrong,
                           const std::string& directory);

// Builds the code again with a negligible number in place of its obvious epsilon, or of all small numbers, and runs it
// on the pairs. Returns nothing if there is no such number, or no C or C++ source.   Throws: Stopped.
std::optional<reports::EpsilonEffect> epsilon_effect(const Lane& own, const std::vector<strata::PairSource>& sources);

struct Answer {
  TriedCode code;
  std::string directory, earlier,
      scene;                              // earlier: new name of the earlier run; scene: the written file
  std::vector<strata::LeftOut> left_out;  // strata that the scene cannot contain
  nlohmann::ordered_json summary, kinds;  // for all lanes
  CallCosts costs;
  OwnEpsilon epsilon;
  std::optional<reports::EpsilonEffect> effect;
  std::vector<nlohmann::ordered_json> told;  // the kinds of failure to print
  std::string test;                          // the file with the first failure as a test; empty if there is none
  std::string again;                         // the command for ten times as many pairs
};

// The file that contains the kind's simplest pair.
std::string case_of(const Answer& answer, const nlohmann::ordered_json& kind);

nlohmann::ordered_json to_json(const Answer& answer, const fuzz::SelectedLanes& under_test);
std::string text_of(const Answer& answer, const reports::Screen& screen);

}  // namespace graze::cli
