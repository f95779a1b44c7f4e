// SPDX-License-Identifier: Apache-2.0
#include "reports/sufficient.h"

#include <fmt/format.h>

#include "core/text.h"
#include "reports/cost_words.h"
#include "reports/terminal.h"

namespace graze::reports {
namespace {

// "at 95 % confidence wrong on under 0.0004 of the pairs (3 of 100,000 fresh pairs)"
std::string errors_words(const Candidate& c) {
  return fmt::format("at 95 % confidence wrong on under {} of the pairs ({} of {} fresh pairs)", rounded_up(c.bound, 2),
                     grouped(c.errors.wrong()), grouped(c.errors.pairs));
}

const Candidate& least_wrong(std::span<const Candidate> candidates, std::optional<Scalar> scalar) {
  const Candidate* least = nullptr;
  for (const Candidate& c : candidates) {
    if ((!scalar || c.scalar == *scalar) && (!least || c.bound < least->bound)) least = &c;
  }
  return *least;
}

// "No published lane of f32 is shown to suffice; the least wrong, …, is wrong on 31 of 100,000 fresh pairs."
std::string none_words(std::span<const Candidate> candidates, std::optional<Scalar> scalar) {
  const Candidate& least = least_wrong(candidates, scalar);
  return fmt::format("No published lane{} is shown to suffice; the least wrong, {}, is wrong on {} of {} fresh pairs.",
                     scalar ? fmt::format(" of {}", name(*scalar)) : "", least.lane, grouped(least.errors.wrong()),
                     grouped(least.errors.pairs));
}

}  // namespace

const Candidate* cheapest_sufficient(std::span<const Candidate> candidates, std::optional<Scalar> scalar) {
  const Candidate* best = nullptr;
  for (const Candidate& c : candidates) {
    if (c.result != analysis::TuneResult::satisfied || (scalar && c.scalar != *scalar)) continue;
    if (!best || c.cost.middle < best->cost.middle) best = &c;
  }
  return best;
}

std::vector<std::string> sufficient_sentences(double rate, std::span<const Candidate> candidates,
                                              const std::string& exact, const analysis::Cost& exact_cost) {
  const std::string asked = fmt::format("Wrong on at most {} of this scene's pairs: ", rate);
  const std::string exact_words = fmt::format("{}, never wrong, {} a pair", exact, cost_words(exact_cost));
  const Candidate* best = cheapest_sufficient(candidates);
  if (!best) return {fmt::format("{}use {}.", asked, exact_words), none_words(candidates, std::nullopt)};
  const Candidate& c = *best;
  const std::string lane_words = fmt::format("{}, {}, {}", c.lane, errors_words(c), cost_words(c.cost));
  std::vector<std::string> sentences;
  if (is_cheaper(c.cost, exact_cost)) {
    sentences = {fmt::format("{}use {} a pair.", asked, lane_words),
                 fmt::format("{} is never wrong and takes {}.", exact, cost_words(exact_cost))};
  } else {
    sentences = {fmt::format("{}use {}.", asked, exact_words),
                 fmt::format("The cheapest published lane that suffices is {}: {}{}.", c.lane, errors_words(c),
                             is_cheaper(exact_cost, c.cost)
                                 ? fmt::format(", and more expensive at {}", cost_words(c.cost))
                                 : fmt::format(", at {} not cheaper beyond the spread of the measurements",
                                               cost_words(c.cost)))};
  }
  const Scalar other = c.scalar == Scalar::f32 ? Scalar::f64 : Scalar::f32;
  if (const Candidate* o = cheapest_sufficient(candidates, other)) {
    sentences.push_back(fmt::format("In {} the cheapest that suffices is {}: {}, {}.", name(other), o->lane,
                                    errors_words(*o), cost_words(o->cost)));
  } else {
    sentences.push_back(none_words(candidates, other));
  }
  return sentences;
}

}  // namespace graze::reports
