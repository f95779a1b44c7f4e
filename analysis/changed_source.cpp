// SPDX-License-Identifier: Apache-2.0
#include "analysis/changed_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "subjects/rebuilt.h"
#include "subjects/subjects.h"

namespace graze::analysis {
namespace {

DecidingNumber told(const Lane& lane, const std::vector<subjects::Epsilon>& numbers, bool on_images, bool doubles) {
  DecidingNumber result{"", "", on_images};
  for (const subjects::Epsilon& number : numbers) {
    const std::string place = places_in_words(subjects::opened(lane.info->id)->file, number);
    if (result.line.empty()) result.line = place;
    result.words += fmt::format("{}{} at {}", result.words.empty() ? "" : ", ", number.name, place);
  }
  result.words = fmt::format("with {} in place of {}{} it is right{}", subjects::negligible_in_words(numbers),
                             result.words, doubles ? " and double in place of float" : "",
                             on_images ? "" : ", but not in every order and mirror image in which it was wrong");
  return result;
}

// A number far below all the given numbers, but large enough that its products do not underflow at once.
double far_below(const std::vector<subjects::Epsilon>& numbers) {
  constexpr double kAboutFltEpsilon = 1e-7;  // for FLT_EPSILON, whose value is not in the source
  double least = 1;
  for (const subjects::Epsilon& number : numbers) least = std::min(least, number.value.value_or(kAboutFltEpsilon));
  return std::max(least * 1e-9, subjects::kNegligible);
}

}  // namespace

std::optional<DecidingNumber> deciding_number(const Lane& lane, const IsRight& is_right,
                                              const IsRight& is_right_on_images, bool doubles) {
  const std::vector<subjects::Epsilon> all = subjects::small_numbers(lane);
  std::vector<std::vector<subjects::Epsilon>> tried;
  for (std::size_t n = 0; n < all.size() && !doubles; ++n) tried.push_back({all[n]});
  if (all.size() > (doubles ? 0 : 1)) tried.push_back(all);
  std::optional<DecidingNumber> on_pair;
  for (const std::vector<subjects::Epsilon>& some : tried) {
    const auto changed = subjects::changed(lane, {.negligible = some, .doubles = doubles});
    if (!changed || !is_right(*changed)) continue;
    const auto smaller = subjects::changed(lane, {.negligible = some, .value = far_below(some), .doubles = doubles});
    if (!smaller || !is_right(*smaller)) continue;
    if (is_right_on_images(*changed)) return told(lane, some, true, doubles);
    if (!on_pair) on_pair = told(lane, some, false, doubles);
  }
  return on_pair;
}

std::optional<InitialValues> by_initial_values(const Lane& lane, Verdict truth,
                                               const std::function<Verdict(const DecideBlock& block)>& verdict_of) {
  bool right[2];
  for (const bool zero : {false, true}) {
    const auto build =
        subjects::changed(lane, {.flags = {fmt::format("-ftrivial-auto-var-init={}", zero ? "zero" : "pattern")}});
    if (!build) return std::nullopt;
    const Verdict verdict = verdict_of(*build);
    if (verdict == Verdict::unstable) return std::nullopt;  // something else changes the verdict
    right[zero] = verdict == truth;
  }
  const auto word = [](bool is_right) { return is_right ? "right" : "wrong"; };
  std::string words = fmt::format("with zero in uninitialised variables it is {}, with another pattern it is {}",
                                  word(right[true]), word(right[false]));
  if (right[false] != right[true]) return InitialValues{std::move(words), true};
  const std::vector<std::string> warnings_are_errors = {"-Werror=uninitialized", "-Werror=maybe-uninitialized"};
  if (!right[true] || subjects::changed(lane, {.flags = warnings_are_errors})) return std::nullopt;
  return InitialValues{words + ", and the compiler warns of one", false};
}

}  // namespace graze::analysis
