// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <set>
#include <stdexcept>

#include "analysis/discrepancy.h"
#include "core/discrepancy/questions.h"
#include "core/lanes/lanes.h"
#include "core/whole.h"
#include "reports/discrepancy_reading.h"
#include "reports/possible_counts.h"
#include "reports/verdicts_apart.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kWidestBand = 2 + 1e-9;  // see band in core/discrepancy/count.h; more than 2 because of rounding

void expect(bool holds, const std::string& what) {
  if (!holds) throw std::runtime_error("impossible counts: " + what);
}

// Checks that no key's count exceeds the count of the key before it.
void expect_falling(const Json& of, std::initializer_list<const char*> keys, const std::string& what) {
  const char* before = nullptr;
  for (const char* key : keys) {
    if (before) expect(number_at(of, key) <= number_at(of, before), what + ": more of " + key + " than of " + before);
    before = key;
  }
}

std::uint64_t sum_of(const Json& histogram) {
  std::uint64_t sum = 0;
  for (const auto& [bucket, unused] : histogram.items()) sum += number_at(histogram, bucket);
  return sum;
}

// Checks that the counts by position on the stratum's axis add up to those over all pairs.
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
         what + ": more signs differ than values and choices");
  for (const Json& unlike : of.at("unlike"))
    expect(unlike.is_number_unsigned() && unlike <= of.at("pairs"), what + ": `unlike` is not a count of its pairs");
  for (const auto& [site, counts] : of.at("sites").items()) {
    expect_falling(counts, {"asked", "differs", "sign"}, what + ", " + site);
    expect(number_at(counts, "asked") <= number_at(of, "pairs"), what + ": more pairs than in total at " + site);
  }
  expect(of.at("questions").size() == questions.size(), what + ": its questions are not those of the algorithm");
  for (std::size_t q = 0; q < questions.size(); ++q) {
    const Json& question = of.at("questions").at(q);
    const std::string place = what + ", " + questions[q].name;
    expect(text_at(question, "question") == questions[q].name, place + " is missing");
    expect(number_at(question, "asked") <= number_at(of, "pairs"), place + ": asked on more pairs than there are");
    expect_falling(question, {"asked", "differs", "sign", "outcome", "verdict"}, place);
    expect_falling(question, {"sign", "zero_on_one_side"}, place);
    expect(sum_of(question.at("band")) == number_at(question, "sign"),
           place + ": the counts of the band do not add up");
    for (const char* largest : {"largest_in_bounds", "largest_length"})
      expect(question.at(largest).get<double>() >= 0, place + ": " + largest);
    expect(question.at("largest_in_bounds") <= kWidestBand, place + ": a band of more than two bounds");
    expect(question.at("values").size() == questions[q].of.size(), place + ": its values are not the question's");
    for (const Json& value : question.at("values")) {
      const std::uint64_t compared = number_at(value, "compared"), equal = number_at(value, "equal");
      expect(compared == number_at(question, "asked"), place + ": `compared` differs from `asked`");
      expect(equal + number_at(value, "zero_sign") + number_at(value, "not_finite") + sum_of(value.at("below")) +
                     sum_of(value.at("above")) ==
                 compared,
             place + ": the counts of differences do not add up");
      for (const char* errors : {"first_error", "second_error"})
        expect(sum_of(value.at(errors)) == compared, place + ": " + errors + " does not add up");
      expect(sum_of(value.at("nearer")) == compared - equal, place + ": the counts of nearer values do not add up");
    }
  }
}

// Adds the numbers of `some` to those with the same keys in `to`. Fields named "largest…" keep the larger value.
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

// The traced pairs are among the compared pairs, so no count may exceed the comparison's count.
void expect_possible_origins(const Json& of, const std::vector<Question>& questions, const std::string& what) {
  const Json &origins = of.at("origins"), &total = of.at("total"), &lines = origins.at("lines");
  expect(number_at(origins, "pairs") <= number_at(total, "pairs"), what + ": more pairs are traced than compared");
  expect_falling(origins, {"pairs", "verdicts"}, what);
  expect(number_at(origins, "verdicts") <= number_at(total, "verdict"),
         what + ": more verdicts are traced than differ");
  std::size_t values = 0;
  for (const Question& question : questions) values += question.of.size();
  for (const Json& line : lines) {
    expect(!text_at(line, "line").empty() && line.at("within").is_string(), what + ": a line without a place");
    expect(number_at(line, "verdicts_fixed") <= number_at(origins, "verdicts"),
           what + ": more verdicts return than changed");
    expect(number_at(line, "verdicts_alone") <= number_at(origins, "pairs"), what + ": more verdicts than pairs");
    expect(number_at(line, "values") <= values * number_at(origins, "pairs"), what + ": more values than are compared");
  }
  std::set<std::pair<std::string, std::string>> seen;
  for (const Json& start : origins.at("starts")) {
    const std::string name = text_at(start, "question"), value = text_at(start, "value");
    const auto question =
        std::find_if(questions.begin(), questions.end(), [&](const Question& q) { return q.name == name; });
    expect(question != questions.end() && std::count(question->of.begin(), question->of.end(), value) == 1 &&
               seen.emplace(name, value).second,
           what + ": no value " + name + ", " + value + ", or it is listed twice");
    std::uint64_t sum = number_at(start, "by_several_lines");
    for (const auto& [line, unused] : start.at("by_line").items()) {
      std::size_t place = lines.size();
      const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), place);
      expect(error == std::errc() && end == line.data() + line.size() && place < lines.size(),
             what + ": a line " + line);
      sum += number_at(start.at("by_line"), line);
    }
    expect(sum <= number_at(origins, "pairs"), what + ", " + name + ": more traced values than pairs");
    expect(sum_of(start.at("growth")) <= sum, what + ", " + name + ": more growths than traced values");
  }
}

}  // namespace

void expect_possible_discrepancy(const Json& json) {
  const Json verdicts = json.value("verdicts", Json::array());
  expect(!json.at("lanes").empty() || !verdicts.empty(), "no lanes");
  expect(json.at("seed").is_number_unsigned() && json["seed"] <= kMostWhole, "the seed " + json["seed"].dump());
  for (const char* name : {"version", "commit", "compiler"}) text_at(json.at("build"), name);
  for (const Json& of : verdicts) expect_possible_verdicts(of);
  std::set<std::set<std::string>> compared;
  for (const Json& of : json.at("lanes")) {
    const std::set<std::string> both{text_at(of, "first"), text_at(of, "second")};
    expect(both.size() == 2 && compared.insert(both).second, "two lanes are the same, or are compared twice");
    const Lane* lanes[2] = {find_lane(text_at(of, "first")), find_lane(text_at(of, "second"))};
    expect(lanes[0] && lanes[1] && lanes[0]->algorithm >= 0 && lanes[0]->algorithm == lanes[1]->algorithm &&
               lanes[0]->scalar == lanes[1]->scalar,
           "not two lanes of one published algorithm and scalar");
    const std::vector<Question>& questions = questions_of(lanes[0]->algorithm);
    expect(of.at("questions") == questions_json(questions), "the questions are not those of the algorithm");
    Json sum;
    for (const auto& [stratum, counts] : of.at("strata").items()) {
      expect_possible_counts(counts, questions, text_at(of, "second") + ", " + stratum);
      Json row = counts;
      row.erase("extremes");
      add(sum, row);
    }
    expect(nlohmann::json(sum) == nlohmann::json(of.at("total")),
           text_at(of, "second") + ": the total is not that of the strata");
    expect(number_at(of.at("total"), "pairs") == number_at(json, "pairs"), "not all pairs are compared");
    const Lane* fused = analysis::fused_of(*lanes[0], *lanes[1]);
    expect(of.at("origins").is_null() || fused, text_at(of, "second") + ": origins without a contraction");
    if (!of["origins"].is_null()) expect_possible_origins(of, questions, text_at(of, "second"));
  }
}

}  // namespace graze::reports
