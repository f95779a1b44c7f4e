// SPDX-License-Identifier: Apache-2.0
// Reads discrepancy.json (docs/formats.md) for its page, sentences and pictures, and names its buckets.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/discrepancy/questions.h"

namespace graze::reports {

// The count at the key.   Throws: nlohmann::json::exception if there is no such key; std::runtime_error if its value is
// not a count.
std::uint64_t number_at(const nlohmann::ordered_json& json, const std::string& key);
inline std::string text_at(const nlohmann::ordered_json& json, const char* key) {
  return json.at(key).get<std::string>();
}

// "A against B" for an entry of "lanes" or "verdicts".
std::string title_of(const nlohmann::ordered_json& of);

// part / whole; 0 if whole is 0.
double part_of(std::uint64_t part, std::uint64_t whole);

// The questions of an algorithm as discrepancy.json lists them: name, site, degree and values.
nlohmann::ordered_json questions_json(const std::vector<Question>& questions);

// octave: the name of the bucket from 2^k to 2^(k+1). octaves_json: a histogram of the nonzero counts by bucket.
std::string octave(int k);
nlohmann::ordered_json octaves_json(std::span<const std::uint64_t> counts);

// The exponent in a bucket name such as "2^-3".
inline int power_of(const std::string& bucket) { return std::stoi(bucket.substr(2)); }

// Counts by the exponent of their bucket.
using Octaves = std::map<int, std::uint64_t>;

// The lowest octave that, together with all lower ones, has at least this share of the counts. Nothing without counts.
std::optional<int> quantile(const Octaves& octaves, double share);

// Reads a histogram whose buckets are all powers of 2.
Octaves octaves_at(const nlohmann::ordered_json& histogram);

// The sizes of the differences in ulps, from the histograms "below" and "above".
Octaves sizes_of(const nlohmann::ordered_json& differences);

// Both sum over all values of all questions. sum_by_bucket adds up a histogram, and sum_at a count.
std::map<std::string, std::uint64_t> sum_by_bucket(const nlohmann::ordered_json& counts, const char* histogram);
std::uint64_t sum_at(const nlohmann::ordered_json& counts, const char* key);

// The lines of "origins", sorted by the number of verdicts that they change, then by the number of values.
std::vector<const nlohmann::ordered_json*> by_weight(const nlohmann::ordered_json& origins);

// Rows of discrepancy.csv for the nonzero counts of an object and of its histograms.
// start: the cells before the count's name, with a comma at the end.
std::string csv_rows(const std::string& start, const nlohmann::ordered_json& counts);

// The entries of "lanes" in which some value differs.
std::vector<const nlohmann::ordered_json*> differing_lanes(const nlohmann::ordered_json& discrepancy);

}  // namespace graze::reports
