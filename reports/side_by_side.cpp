// SPDX-License-Identifier: Apache-2.0
#include "reports/discrepancy.h"

#include <fmt/format.h>

#include <cmath>

#include "analysis/lane_trace.h"
#include "core/discrepancy/count.h"
#include "reports/terminal.h"
#include "reports/text_table.h"

namespace graze::reports {
namespace {

using analysis::ValueBeside;

std::string value_text(const std::optional<double>& value, Scalar scalar) {
  if (!value) return "-";
  return scalar == Scalar::f32 ? fmt::format("{}", static_cast<float>(*value)) : fmt::format("{}", *value);
}

std::string apart_text(const ValueBeside& value, Scalar scalar) {
  if (!value.compared || !value.first || !value.second) return "-";
  if (std::isnan(*value.first) && std::isnan(*value.second)) return "0";
  if (!std::isfinite(*value.first) || !std::isfinite(*value.second)) return *value.first == *value.second ? "0" : "?";
  return grouped(analysis::ulps_apart(scalar, *value.first, *value.second));
}

std::string exact_text(const ValueBeside& value) {
  if (!value.unrounded || !value.unrounded->exact.settled()) return "-";
  return value.unrounded->exact.is_exactly_zero() ? "0" : fmt::format("{:.9g}", value.unrounded->exact.hi);
}

std::string error_text(const std::optional<double>& value, const ValueBeside& of, Scalar scalar) {
  if (!value || !of.unrounded || !of.compared) return "-";
  const std::string bucket = analysis::error_bucket_of(scalar, *value, of.unrounded->exact);
  return bucket == "0" || bucket == "unknown" || bucket == "not finite" ? bucket : "≤ " + bucket;
}

// Whether the comparison of this value has different outcomes in the two lanes. left: the left value of a question
// about two values, otherwise null.
bool goes_otherwise(const Question& question, const ValueBeside* left, const ValueBeside& value) {
  if (!value.compared || !value.first || !value.second) return false;
  if (question.of.size() == 1) return sign_of_value(*value.first) != sign_of_value(*value.second);
  if (value.which == 0 || !left) return false;
  return answers_otherwise(order_of(*left->first, *value.first), order_of(*left->second, *value.second),
                           question.at_most);
}

// "disjoint"; if the lane itself answers otherwise, "disjoint in its recorded run, which is compiled separately from
// the lane itself (intersects)".
std::string verdicts_in_words(const Lane& lane, const AnyPair& pair, const RecordedPath& recorded) {
  const Verdict there = recorded_verdict(recorded.path), own = lane.decide ? analysis::decide_lane(lane, pair) : there;
  return own == there ? std::string(name(there))
                      : fmt::format("{} in its recorded run, which is compiled separately from the lane itself ({})",
                                    name(there), name(own));
}

}  // namespace

std::string side_by_side(const analysis::LanesCompared& lanes, const AnyPair& pair, const Screen& screen) {
  const analysis::RunsBeside runs = analysis::runs_beside(lanes, pair);
  const std::vector<Question>& questions = questions_of(lanes.first->algorithm);
  const Scalar scalar = lanes.first->scalar;
  TextTable table({{"value", Align::left},
                   {"first"},
                   {"second"},
                   {"ulps apart"},
                   {"exact"},
                   {"error, first"},
                   {"error, second"},
                   {"", Align::left}});
  bool differs = false, otherwise = false;
  for (std::size_t v = 0; v < runs.values.size(); ++v) {
    const ValueBeside& value = runs.values[v];
    const Question& question = questions[static_cast<std::size_t>(value.question)];
    const std::string apart = apart_text(value, scalar);
    const bool other = goes_otherwise(question, v > 0 ? &runs.values[v - 1] : nullptr, value);
    std::string note = other ? question.of.size() == 1 ? "other sign" : "goes the other way" : "";
    if (note.empty() && !value.compared) note = value.first && value.second ? "another quantity" : "one lane alone";
    differs = differs || (apart != "0" && apart != "-");
    otherwise = otherwise || other;
    table.add({question.of[static_cast<std::size_t>(value.which)], value_text(value.first, scalar),
               value_text(value.second, scalar), Cell(apart, apart != "0" && apart != "-"), exact_text(value),
               error_text(value.first, value, scalar), error_text(value.second, value, scalar), Cell(note, other)});
  }
  const std::string first = verdicts_in_words(*lanes.first, pair, runs.first),
                    second = verdicts_in_words(*lanes.second, pair, runs.second);
  const std::string values = differs
                                 ? otherwise ? "a comparison goes the other way" : "values differ, no comparison does"
                                 : "every value has the same bits";
  return wrapped(fmt::format("first: {}, {}; second: {}, {}: {}. Errors are in ulps of the exact value along the first "
                             "lane's path.",
                             lanes.first->id, first, lanes.second->id, second, values),
                 screen.columns, 2, 4) +
         table.text(screen, 2);
}

}  // namespace graze::reports
