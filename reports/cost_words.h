// SPDX-License-Identifier: Apache-2.0
// Formats all costs in the same way: nanoseconds per pair with the quartiles of the passes. Describes what was timed.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/pareto.h"

namespace graze::reports {

// Whether the quartiles are further apart than a quarter of the median, for example because another program ran or the
// clock rate changed. Two such measurements of one lane may differ by more than their quartiles.
bool is_noisy(const analysis::Cost& cost);

// Whether the cost is lower and the spreads do not overlap.
bool is_cheaper(const analysis::Cost& cost, const analysis::Cost& other);

// "8.5 ns (8.4 to 8.9)", "284 ns (205 to 1,289; noisy)", "0.0204 ns (0.0203 to 0.0204)"
std::string cost_words(const analysis::Cost& cost);

// "Costs are times per pair on one core of MACHINE, with the quartiles of 9 passes: calls of many pairs, on PAIRS. …"
// pairs: the name of the timed pairs, such as "the first 1,024 pairs of each stratum".
std::string costs_sentence(analysis::Calls calls, const std::string& pairs, const std::string& machine, int passes);

// "A call of one pair takes 41 ns (40 to 43) in mine/f32/cpu, 73 ns (72 to 75) in exact/f32/cpu: median and quartiles
// of 101 passes over PAIRS, on one core of MACHINE." This form is short because the terminal shows other results too.
std::string one_call_sentence(std::span<const std::string> lanes, std::span<const analysis::Cost> costs,
                              const std::string& pairs, const std::string& machine, int passes);

// "Noisy measurements: A, B; …"; empty if no cost is noisy. For tables that show only medians.
std::string noisy_sentence(std::span<const std::string> lanes, std::span<const analysis::Cost> costs);

}  // namespace graze::reports
