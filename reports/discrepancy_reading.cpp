// SPDX-License-Identifier: Apache-2.0
#include "reports/discrepancy_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace graze::reports {

using nlohmann::ordered_json;

std::uint64_t number_at(const ordered_json& json, const std::string& key) {
  const ordered_json& number = json.at(key);
  if (!number.is_number_unsigned()) throw std::runtime_error("expected a count in " + key + ", found " + number.dump());
  return number.get<std::uint64_t>();
}

std::string title_of(const ordered_json& of) { return text_at(of, "first") + " against " + text_at(of, "second"); }

double part_of(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::string octave(int k) { return fmt::format("2^{}", k); }

ordered_json octaves_json(std::span<const std::uint64_t> counts) {
  ordered_json histogram = ordered_json::object();
  for (std::size_t k = 0; k < counts.size(); ++k) {
    if (counts[k]) histogram[octave(static_cast<int>(k))] = counts[k];
  }
  return histogram;
}

ordered_json questions_json(const std::vector<Question>& questions) {
  ordered_json list = ordered_json::array();
  for (const Question& question : questions) {
    list.push_back({{"question", question.name},
                    {"site", site_name(question.site)},
                    {"degree", question.degree},
                    {"values", question.of}});
  }
  return list;
}

std::optional<int> quantile(const Octaves& octaves, double share) {
  std::uint64_t all = 0, so_far = 0;
  for (const auto& [k, count] : octaves) all += count;
  for (const auto& [k, count] : octaves) {
    so_far += count;
    if (all > 0 && static_cast<double>(so_far) >= share * static_cast<double>(all)) return k;
  }
  return {};
}

Octaves octaves_at(const ordered_json& histogram) {
  Octaves octaves;
  for (const auto& [bucket, count] : histogram.items()) octaves[power_of(bucket)] += count.get<std::uint64_t>();
  return octaves;
}

Octaves sizes_of(const ordered_json& differences) {
  Octaves sizes = octaves_at(differences.at("below"));
  for (const auto& [k, count] : octaves_at(differences.at("above"))) sizes[k] += count;
  return sizes;
}

std::map<std::string, std::uint64_t> sum_by_bucket(const ordered_json& counts, const char* histogram) {
  std::map<std::string, std::uint64_t> sums;
  for (const ordered_json& question : counts.at("questions")) {
    for (const ordered_json& value : question.at("values")) {
      for (const auto& [bucket, count] : value.at(histogram).items()) sums[bucket] += count.get<std::uint64_t>();
    }
  }
  return sums;
}

std::uint64_t sum_at(const ordered_json& counts, const char* key) {
  std::uint64_t sum = 0;
  for (const ordered_json& question : counts.at("questions")) {
    for (const ordered_json& value : question.at("values")) sum += number_at(value, key);
  }
  return sum;
}

std::vector<const ordered_json*> by_weight(const ordered_json& origins) {
  std::vector<const ordered_json*> lines;
  for (const ordered_json& line : origins.at("lines")) lines.push_back(&line);
  const auto weight = [](const ordered_json* line) {
    return std::pair(number_at(*line, "verdicts_fixed"), number_at(*line, "values"));
  };
  std::stable_sort(lines.begin(), lines.end(), [&](auto l, auto r) { return weight(l) > weight(r); });
  return lines;
}

std::string csv_rows(const std::string& start, const ordered_json& counts) {
  std::string text;
  for (const auto& [name, count] : counts.items()) {
    if (count.is_number_unsigned() && count != 0) text += fmt::format("{}{},,{}\n", start, name, count.dump());
    if (!count.is_object()) continue;
    for (const auto& [bucket, part] : count.items()) {
      if (part.is_number_unsigned()) text += fmt::format("{}{},{},{}\n", start, name, bucket, part.dump());
    }
  }
  return text;
}

std::vector<const ordered_json*> differing_lanes(const ordered_json& discrepancy) {
  std::vector<const ordered_json*> lanes;
  for (const ordered_json& of : discrepancy.at("lanes")) {
    if (number_at(of.at("total"), "differs") > 0) lanes.push_back(&of);
  }
  return lanes;
}

}  // namespace graze::reports
