// SPDX-License-Identifier: Apache-2.0
// Counts as JSON, with the same keys in campaigns, the league, tune, pareto and reports.
#pragma once

#include <nlohmann/json.hpp>

#include "core/counts.h"

namespace graze::fuzz {

struct CountField {
  const char* key;
  std::uint64_t Counts::*count;
  bool foreign;  // whether only foreign code has this count
};
inline constexpr CountField kCountFields[] = {{"false_positive", &Counts::false_positive, false},
                                              {"false_negative", &Counts::false_negative, false},
                                              {"declined", &Counts::declined, false},
                                              {"crashed", &Counts::crashed, true},
                                              {"timed_out", &Counts::timed_out, true},
                                              {"unstable", &Counts::unstable, true},
                                              {"by_convention", &Counts::by_convention, true}};

// Returns the counts as an object; the fields of foreign code are included only if `foreign` is true.
inline nlohmann::ordered_json counts_json(const Counts& counts, bool foreign = false) {
  nlohmann::ordered_json row = nlohmann::ordered_json::object();
  for (const CountField& field : kCountFields) {
    if (foreign || !field.foreign) row[field.key] = counts.*field.count;
  }
  return row;
}

// Reads an object of counts_json. Unknown fields are ignored, and the fields of foreign code may be missing.
// Throws: Json::exception if a required field is missing, or a known field is not a count.
inline Counts counts_of(const nlohmann::ordered_json& row) {
  Counts counts;
  for (const CountField& field : kCountFields) {
    if (!field.foreign || row.contains(field.key)) counts.*field.count = row.at(field.key).get<std::uint64_t>();
  }
  return counts;
}

}  // namespace graze::fuzz
