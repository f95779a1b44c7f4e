// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <stdexcept>

#include "core/discrepancy/questions.h"
#include "core/lanes/lanes.h"
#include "reports/discrepancy_reading.h"
#include "reports/possible_counts.h"
#include "reports/verdicts_apart.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kWidestBand = 2 + 1e-9;  // see band in core/discrepancy/count.h; its sums and quotient are rounded

void expect(bool holds, const std::string& what) {
  if (!holds) throw std::runtime_error("impossible counts: " + what);
}

// Each of these keys is at most the one before.
void expect_falling(const Json& of, std::initializer_list<const char*> keys, const std::string& what) {
  const char* before = nullptr;
  for (const char* key : keys) {
    if (before) expect(number_at(of, key) <= number_at(of, before), what + ": more of " + key + " than of " + before);
    before = key;
  }
}

std::uint64_t sum_of(const Json& histogram) {
  std::uint64_t sum = 0;
  for (const auto& [bucket, count] : histogram.items()) sum += count.get<std::uint64_t>();
  return sum;
}

// The pairs by their place on the stratum's axis are all pairs.
void expect_extremes(const Json& of, const std::string& what) {
  for (const auto& [axis, places] : of.at("extremes").items()) {
    expect(axis == "scale" || axis == "offset", what + ": extremes of " + axis);
    for (const char* count : {"pairs", "differs", "sign", "outcome", "choice", "verdict"}) {
      std::uint64_t sum = 0;
      for (const auto& [place, counts] : places.items()) sum += number_at(counts, count);
      expect(sum == number_at(of, count), what + ": the extremes do not add up to " + count);
    }
  }
}

void expect_possible_counts(const Json& of, const std::vector<Question>& questions, const std::string& what) {
  expect_falling(of, {"pairs", "differs"}, what);
  expect_falling(of, {"pairs", "sign", "outcome", "verdict"}, what);
  expect_falling(of, {"outcome", "choice"}, what);
  if (of.contains("extremes")) expect_extremes(of, what);
  expect(number_at(of, "sign") <= number_at(of, "differs") + number_at(of, "choice"),
         what + ": more signs than values and choices");
  for (const Json& unlike : of.at("unlike"))
    expect(unlike.get<std::uint64_t>() <= number_at(of, "pairs"), what + ": unlike");
  for (const auto& [site, counts] : of.at("sites").items()) {
    expect_falling(counts, {"asked", "differs", "sign"}, what + ", " + site);
    expect(number_at(counts, "asked") <= number_at(of, "pairs"), what + ": more pairs at " + site);
  }
  expect(of.at("questions").size() == questions.size(), what + ": other questions than the algorithm's");
  for (std::size_t q = 0; q < questions.size(); ++q) {
    const Json& question = of.at("questions").at(q);
    const std::string place = what + ", " + questions[q].name;
    expect(text_at(question, "question") == questions[q].name, place + " is not there");
    expect(number_at(question, "asked") <= number_at(of, "pairs"), place + ": asked of more pairs");
    expect_falling(question, {"asked", "differs", "sign", "outcome", "verdict"}, place);
    expect_falling(question, {"sign", "zero_on_one_side"}, place);
    expect(sum_of(question.at("band")) == number_at(question, "sign"), place + ": the band does not add up");
    for (const char* largest : {"largest_in_bounds", "largest_length"})
      expect(question.at(largest).get<double>() >= 0, place + ": " + largest);
    expect(question.at("largest_in_bounds") <= kWidestBand, place + ": a band of more than two bounds");
    expect(question.at("values").size() == questions[q].of.size(), place + ": other values");
    for (const Json& value : question.at("values")) {
      const std::uint64_t compared = number_at(value, "compared"), equal = number_at(value, "equal");
      expect(compared == number_at(question, "asked"), place + ": compared is not asked");
      expect(equal + number_at(value, "zero_sign") + number_at(value, "not_finite") + sum_of(value.at("below")) +
                     sum_of(value.at("above")) ==
                 compared,
             place + ": the differences do not add up");
      for (const char* errors : {"first_error", "second_error"})
        expect(sum_of(value.at(errors)) == compared, place + ": " + errors + " does not add up");
      expect(sum_of(value.at("nearer")) == compared - equal, place + ": nearer does not add up");
    }
  }
}

// The sum of numbers at the same places; largest ones stay the largest.
void add(Json& to, const Json& some, const std::string& key = "") {
  if (some.is_number_float() || key.starts_with("largest")) {
    to = std::max(to.is_null() ? 0.0 : to.get<double>(), some.get<double>());
  } else if (some.is_number()) {
    to = (to.is_null() ? 0 : to.get<std::uint64_t>()) + some.get<std::uint64_t>();
  } else if (some.is_array()) {
    for (std::size_t i = 0; i < some.size(); ++i) add(to[i], some[i]);
  } else if (some.is_object()) {
    if (to.is_null()) to = Json::object();
    for (const auto& [name, part] : some.items()) add(to[name], part, name);
  } else {
    to = some;
  }
}

}  // namespace
void expect_possible_discrepancy(const Json& json) {
  const Json verdicts = json.value("verdicts", Json::array());
  expect(!json.at("lanes").empty() || !verdicts.empty(), "no lanes");
  for (const Json& of : verdicts) expect_possible_verdicts(of);
  for (const Json& of : json.at("lanes")) {
    const Lane* lanes[2] = {find_lane(text_at(of, "first")), find_lane(text_at(of, "second"))};
    expect(lanes[0] && lanes[1] && lanes[0]->algorithm >= 0 && lanes[0]->algorithm == lanes[1]->algorithm &&
               lanes[0]->scalar == lanes[1]->scalar,
           "not two lanes of one published algorithm and scalar");
    const std::vector<Question>& questions = questions_of(lanes[0]->algorithm);
    Json sum;
    for (const auto& [stratum, counts] : of.at("strata").items()) {
      expect_possible_counts(counts, questions, text_at(of, "second") + ", " + stratum);
      Json row = counts;
      row.erase("extremes");
      add(sum, row);
    }
    expect(nlohmann::json(sum) == nlohmann::json(of.at("total")),
           text_at(of, "second") + ": the total is not that of the strata");
  }
}

}  // namespace graze::reports
