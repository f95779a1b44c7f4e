// SPDX-License-Identifier: Apache-2.0
#include "reports/discrepancy.h"

#include <fmt/format.h>

#include <bit>

#include "core/discrepancy/count.h"
#include "reports/discrepancy_reading.h"
#include "reports/findings.h"
#include "reports/plain_figures.h"
#include "reports/terminal.h"
#include "reports/text_table.h"
#include "reports/verdicts_apart.h"

namespace graze::reports {
namespace {

using analysis::Discrepancies;
using analysis::DiscrepancyCounts;
using analysis::DiscrepancySpec;
using analysis::LanesCompared;
using Json = nlohmann::ordered_json;

// A count's name and index. bucket: the bucket's name if the count belongs to a histogram, else empty.
struct Field {
  std::string name;
  int at;
  std::string bucket;
};

void add_octaves(std::vector<Field>& fields, const char* name, int at, int count, int lowest) {
  for (int k = 0; k < count; ++k) fields.push_back({name, at + k, octave(lowest + k)});
}

std::vector<Field> value_fields() {
  using namespace value_counts;
  std::vector<Field> fields = {
      {"compared", compared, ""}, {"equal", equal, ""}, {"zero_sign", zero_sign, ""}, {"not_finite", not_finite, ""}};
  add_octaves(fields, "below", below, kOctaves, 0);
  add_octaves(fields, "above", above, kOctaves, 0);
  for (const auto& [name, at] : {std::pair{"first_error", first_error}, std::pair{"second_error", second_error}}) {
    for (int bucket = 0; bucket < kErrors; ++bucket)
      fields.push_back({name, at + bucket, analysis::error_bucket_name(bucket)});
  }
  fields.push_back({"nearer", nearer_first, "first"});
  fields.push_back({"nearer", nearer_second, "second"});
  fields.push_back({"nearer", equally_near, "equal"});
  fields.push_back({"nearer", nearer_unknown, "unknown"});
  return fields;
}

std::vector<Field> question_fields() {
  using namespace question_counts;
  std::vector<Field> fields = {{"asked", asked, ""},     {"differs", differs, ""},
                               {"sign", sign, ""},       {"zero_on_one_side", zero_on_one_side, ""},
                               {"outcome", outcome, ""}, {"verdict", verdict, ""}};
  add_octaves(fields, "band", band, kBands, kLowestBand);
  fields.push_back({"band", band_unknown, "unknown"});
  return fields;
}

const std::vector<Field> kPairFields = {{"pairs", pair_counts::pairs, ""},   {"differs", pair_counts::differs, ""},
                                        {"sign", pair_counts::sign, ""},     {"outcome", pair_counts::outcome, ""},
                                        {"choice", pair_counts::choice, ""}, {"verdict", pair_counts::verdict, ""}};
const std::vector<Field> kSiteFields = {
    {"asked", site_counts::asked, ""}, {"differs", site_counts::differs, ""}, {"sign", site_counts::sign, ""}};

// Returns the counts as a JSON object, in which a histogram is an object with its nonzero buckets.
Json object_of(const std::vector<Field>& fields, const DiscrepancyCounts& of, int at) {
  Json object = Json::object();
  for (const Field& field : fields) {
    const std::uint64_t count = of.counts[static_cast<std::size_t>(at + field.at)];
    if (field.bucket.empty()) {
      object[field.name] = count;
    } else {
      if (!object.contains(field.name)) object[field.name] = Json::object();
      if (count) object[field.name][field.bucket] = count;
    }
  }
  return object;
}

double largest(const DiscrepancyCounts& of, std::size_t question, int which) {
  return std::bit_cast<double>(of.maxima[question * band_maxima::kFields + static_cast<std::size_t>(which)]);
}

// The counts of pairs by log2 of their position on the axis.
Json extremes_json(const DiscrepancyCounts& of, Axis axis) {
  Json places = Json::object();
  for (int place = -kBucketMost; place <= kBucketMost; ++place) {
    const Json counts = object_of(kPairFields, of, place_at(place));
    if (counts.at("pairs") > 0) places[std::to_string(exponent_of(axis, static_cast<std::int8_t>(place)))] = counts;
  }
  return places;
}

// axis: the stratum's axis. Sums over strata have no axis, because strata vary different quantities.
Json counts_json(const DiscrepancyCounts& of, const std::vector<Question>& questions, std::optional<Axis> axis) {
  static const std::vector<Field> kQuestion = question_fields(), kValue = value_fields();
  Json json = object_of(kPairFields, of, 0);
  json["unlike"] = {of.unlike[0], of.unlike[1]};
  if (axis) {
    json["extremes"] = Json::object();
    if (*axis != Axis::none) json["extremes"][std::string(name(*axis))] = extremes_json(of, *axis);
  }
  for (int site = 0; site <= kSiteCount; ++site)
    json["sites"][std::string(site_name(site))] = object_of(kSiteFields, of, site_at(site));
  for (std::size_t q = 0; q < questions.size(); ++q) {
    const int question = static_cast<int>(q);
    Json row = {{"question", questions[q].name}};
    row.update(object_of(kQuestion, of, question_at(question)));
    row["largest_in_bounds"] = largest(of, q, band_maxima::in_bounds);
    row["largest_length"] = largest(of, q, band_maxima::length);
    for (std::size_t v = 0; v < questions[q].of.size(); ++v) {
      Json value = {{"value", questions[q].of[v]}};
      value.update(object_of(kValue, of, value_at(question, static_cast<int>(v))));
      row["values"].push_back(std::move(value));
    }
    json["questions"].push_back(std::move(row));
  }
  return json;
}

DiscrepancyCounts total(const LanesCompared& lanes, const std::vector<DiscrepancyCounts>& of_sources) {
  DiscrepancyCounts sum(lanes.first->algorithm);
  for (const DiscrepancyCounts& counts : of_sources) sum += counts;
  return sum;
}

// The quantile of the differing values' distances in ulps: "1", "≤ 63"; "-" if none differs.
std::string ulps_of(const Octaves& octaves, double share) {
  const std::optional<int> k = quantile(octaves, share);
  if (!k) return "-";
  return *k == 0 ? "1" : *k < 20 ? fmt::format("≤ {}", (std::uint64_t{2} << *k) - 1) : fmt::format("< 2^{}", *k + 1);
}

constexpr std::size_t kMostLines = 10;

std::string origins_table(const Json& origins, const Screen& screen) {
  TextTable table(
      {{"fused line", Align::left}, {"within", Align::left}, {"values"}, {"verdicts alone"}, {"verdicts fixed"}});
  for (const Json* line : by_weight(origins)) {
    const std::uint64_t values = number_at(*line, "values"), alone = number_at(*line, "verdicts_alone"),
                        fixed = number_at(*line, "verdicts_fixed");
    if (values + alone + fixed == 0) continue;
    table.add({text_at(*line, "line"), text_at(*line, "within"), grouped(values), Cell(grouped(alone), alone > 0),
               Cell(grouped(fixed), fixed > 0)});
    if (table.rows() == kMostLines) break;
  }
  return wrapped(
             fmt::format("Contraction changes the verdict on {} of {} examined pairs. Source lines whose products are "
                         "fused, by effect (values, verdicts alone: how many change if only this line is fused; "
                         "verdicts fixed: how many changed verdicts change back if only this line is not fused):",
                         grouped(number_at(origins, "verdicts")), grouped(number_at(origins, "pairs"))),
             screen.columns) +
         table.text(screen);
}

Json origins_json(const analysis::Origins& origins, const std::vector<Question>& questions) {
  Json lines = Json::array(), starts = Json::array();
  for (const analysis::FusedLine& line : origins.lines) {
    lines.push_back({{"line", line_of(line.at)},
                     {"within", line_of(line.from)},
                     {"values", line.values},
                     {"verdicts_alone", line.verdicts_alone},
                     {"verdicts_fixed", line.verdicts_fixed},
                     {"simplest", line.simplest ? coordinates_of(*line.simplest) : Json()}});
  }
  for (const auto& [place, start] : origins.starts) {
    Json by_line = Json::object();
    for (std::size_t l = 0; l < origins.lines.size(); ++l) {
      if (start.by_line[l]) by_line[std::to_string(l)] = start.by_line[l];
    }
    starts.push_back(
        {{"value", questions[static_cast<std::size_t>(place.first)].of[static_cast<std::size_t>(place.second)]},
         {"question", questions[static_cast<std::size_t>(place.first)].name},
         {"by_line", by_line},
         {"by_several_lines", start.by_line.back()},
         {"growth", octaves_json(start.growth)}});
  }
  return {{"pairs", origins.pairs}, {"verdicts", origins.verdicts}, {"lines", lines}, {"starts", starts}};
}

}  // namespace

Json discrepancy_json(const DiscrepancySpec& spec, const Discrepancies& found,
                      const std::vector<std::optional<analysis::Origins>>& origins) {
  Json all = Json::array();
  for (std::size_t l = 0; l < spec.lanes.size(); ++l) {
    const LanesCompared& lanes = spec.lanes[l];
    const std::vector<Question>& questions = questions_of(lanes.first->algorithm);
    Json strata = Json::object();
    for (std::size_t s = 0; s < spec.sources.size(); ++s)
      strata[spec.sources[s].id] = counts_json(found[l][s], questions, spec.sources[s].axis);
    all.push_back({{"first", lanes.first->id},
                   {"second", lanes.second->id},
                   {"questions", questions_json(questions)},
                   {"total", counts_json(total(lanes, found[l]), questions, {})},
                   {"strata", strata},
                   {"origins", origins[l] ? origins_json(*origins[l], questions) : Json()}});
  }
  return {{"lanes", all}};
}

std::string discrepancy_tables(const Json& json, const Screen& screen) {
  std::string text;
  for (const Json& of : json.at("lanes")) {
    TextTable table({{"question", Align::left},
                     {"asked"},
                     {"differs"},
                     {"median"},
                     {"99 %"},
                     {"largest"},
                     {"2nd nearer"},
                     {"sign"},
                     {"outcome"},
                     {"verdict"},
                     {"band"}});
    for (const Json& question : of.at("total").at("questions")) {
      const auto number = [&](const char* key) { return number_at(question, key); };
      if (number("differs") == 0) continue;
      Octaves octaves;  // histogram of the distances of all the question's values
      std::uint64_t first = 0, second = 0;
      for (const Json& value : question.at("values")) {
        for (const auto& [k, count] : sizes_of(value)) octaves[k] += count;
        first += value.at("nearer").value("first", std::uint64_t{0});
        second += value.at("nearer").value("second", std::uint64_t{0});
      }
      const std::uint64_t asked = number("asked"), sign = number("sign"), outcome = number("outcome");
      table.add({text_at(question, "question"), grouped(asked), rate_words(number("differs"), asked),
                 ulps_of(octaves, 0.5), ulps_of(octaves, 0.99), ulps_of(octaves, 1),
                 first + second == 0 ? "-" : bare_percent(second, first + second) + " %",
                 Cell(rate_words(sign, asked), sign > 0), Cell(rate_words(outcome, asked), outcome > 0),
                 Cell(grouped(number("verdict")), number("verdict") > 0),
                 sign == 0 ? "-" : fmt::format("{:.3g}", question.at("largest_in_bounds").get<double>())});
    }
    const bool any = table.rows() > 0;
    text += wrapped(title_of(of) + (any ? ":" : ": no bit of any value differs."), screen.columns);
    if (any) text += table.text(screen);
    if (!of.at("origins").is_null()) text += origins_table(of["origins"], screen);
  }
  return text;
}

std::string comparisons_table(const Json& json, const Screen& screen) {
  TextTable table({{"first", Align::left},
                   {"second", Align::left},
                   {"pairs"},
                   {"a value differs"},
                   {"a sign"},
                   {"a comparison"},
                   {"the verdict"}});
  for (const Json& of : json.at("lanes")) {
    const Json& total = of.at("total");
    const std::uint64_t pairs = number_at(total, "pairs");
    std::vector<Cell> row = {text_at(of, "first"), text_at(of, "second"), grouped(pairs)};
    for (const char* key : {"differs", "sign", "outcome", "verdict"}) {
      const std::uint64_t count = number_at(total, key);
      row.emplace_back(rate_words(count, pairs), count > 0);
    }
    table.add(std::move(row));
  }
  return table.text(screen);
}

std::string discrepancy_csv(const Json& json) {
  std::string text = "first,second,stratum,question,value,count,bucket,pairs\n";
  for (const Json& of : json.at("lanes")) {
    for (const auto& [stratum, counts] : of.at("strata").items()) {
      const auto add = [&, id = stratum](const std::string& question, const std::string& value, const Json& some) {
        text += csv_rows(
            fmt::format("{},{},{},\"{}\",\"{}\",", text_at(of, "first"), text_at(of, "second"), id, question, value),
            some);
      };
      add("", "", counts);
      for (const auto& [axis, places] : counts.at("extremes").items()) {
        for (const auto& [place, some] : places.items()) add(axis, "2^" + place, some);
      }
      for (const auto& [site, some] : counts.at("sites").items()) add(site, "", some);
      for (const Json& question : counts.at("questions")) {
        add(text_at(question, "question"), "", question);
        for (const Json& value : question.at("values"))
          add(text_at(question, "question"), text_at(value, "value"), value);
      }
    }
  }
  return text;
}

}  // namespace graze::reports
