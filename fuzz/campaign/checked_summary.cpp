// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/checked_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "analysis/signature.h"
#include "core/cannot.h"
#include "core/lanes/lanes.h"
#include "core/margin/bucket.h"
#include "core/text.h"
#include "core/whole.h"
#include "corpus/pair_format.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/counts_json.h"
#include "fuzz/sealed.h"
#include "strata/pair_source.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;

// Thrown for a summary with impossible counts, which what() describes.
struct Impossible : std::runtime_error {
  using std::runtime_error::runtime_error;
};

void expect(bool possible, const std::string& expected, std::uint64_t found) {
  if (!possible)
    throw Impossible(fmt::format("its counts contradict each other: expected {}, found {}", expected, found));
}

std::uint64_t count(const Json& row, const char* field) {
  const Json& value = row.at(field);
  if (!value.is_number_unsigned())
    throw Impossible(fmt::format("expected a count as {}, found {}", field, value.dump()));
  return value.get<std::uint64_t>();
}

// Checks that rows {"pairs", "wrong": {lane: count}, "differs_from_cpu": {lane: count}} add up to the stratum's counts.
void expect_split(const std::string& where, const Json& rows, const Json& stratum) {
  std::uint64_t pairs = 0;
  std::map<std::string, std::uint64_t> wrong, differ;
  constexpr const char *kWrong = "wrong verdicts", *kDiffer = "verdicts that differ from cpu";
  for (const auto& [name, row] : rows.items()) {
    pairs += count(row, "pairs");
    for (const auto& [field, what, sums] :
         {std::tuple("wrong", kWrong, &wrong), {"differs_from_cpu", kDiffer, &differ}}) {
      for (const auto& [lane, unused] : row.at(field).items()) {
        const std::uint64_t of_lane = count(row[field], lane.c_str());
        expect(of_lane <= count(row, "pairs"),
               fmt::format("at most {} {} of {} at {} {}", count(row, "pairs"), what, lane, where, name), of_lane);
        (*sums)[lane] += of_lane;
      }
    }
  }
  expect(pairs == count(stratum, "pairs"), fmt::format("exactly {} pairs by {}", count(stratum, "pairs"), where),
         pairs);
  for (const auto& [lane, row] : stratum.at("lanes").items()) {
    const std::uint64_t wrong_in_all = counts_of(row).wrong(),
                        differ_in_all = row.at("differs_from_cpu").is_null() ? 0 : count(row, "differs_from_cpu");
    expect(wrong[lane] == wrong_in_all, fmt::format("exactly {} {} of {} by {}", wrong_in_all, kWrong, lane, where),
           wrong[lane]);
    expect(differ[lane] == differ_in_all, fmt::format("exactly {} {} of {} by {}", differ_in_all, kDiffer, lane, where),
           differ[lane]);
  }
}

// Checks that no intersecting pair has a positive margin, and that wrong verdicts match the sign of the margin.
void expect_sides(const Json& stratum) {
  const Json& margins = stratum.at("margins");
  std::size_t known = 0;
  std::uint64_t pairs = 0;
  std::map<std::string, std::uint64_t> wrong[2];  // [0] on disjoint pairs, [1] on intersecting pairs
  for (int b = -kBucketMost; b <= kBucketMost; ++b) {
    const auto row = margins.find(name_of_bucket(static_cast<Bucket>(b)));
    if (row == margins.end()) continue;
    ++known;
    if (b <= 0) pairs += count(*row, "pairs");
    for (const auto& [lane, unused] : row->at("wrong").items())
      wrong[b <= 0][lane] += count(row->at("wrong"), lane.c_str());
  }
  if (known != margins.size()) throw Impossible("it has margins with invalid names");
  const std::uint64_t intersects = count(stratum, "intersects");
  expect(pairs == intersects, fmt::format("exactly {} pairs that intersect, by margin", intersects), pairs);
  for (const auto& [lane, row] : stratum.at("lanes").items()) {
    for (const auto& [field, side] : {std::pair("false_positive", 0), {"false_negative", 1}})
      expect(count(row, field) <= wrong[side][lane],
             fmt::format("at most {} {} of {} by margin", wrong[side][lane], field, lane), count(row, field));
  }
}

void expect_possible(const Json& stratum) {
  const std::uint64_t pairs = count(stratum, "pairs"), intersects = count(stratum, "intersects");
  expect(intersects <= pairs, fmt::format("at most {} pairs that intersect", pairs), intersects);
  for (const auto& [lane, row] : stratum.at("lanes").items()) {
    const auto most = [&](const char* field, std::uint64_t limit) {
      expect(count(row, field) <= limit, fmt::format("at most {} {} of {}", limit, field, lane), count(row, field));
    };
    most("false_positive", pairs - intersects);
    most("false_negative", intersects);
    for (const CountField& field : kCountFields) {
      if (!field.foreign || row.contains(field.key)) most(field.key, pairs);
    }
    if (!row.at("differs_from_cpu").is_null()) most("differs_from_cpu", pairs);
    const Counts counts = counts_of(row);
    if (row.contains("stored")) most("stored", counts.false_positive + counts.false_negative);
    const std::uint64_t judged = counts.not_true();
    expect(judged <= pairs, fmt::format("at most {} verdicts of {} that differ from the truth", pairs, lane), judged);
  }
  expect_split("margin", stratum.at("margins"), stratum);
  expect_sides(stratum);
  const Json extremes = stratum.value("extremes", Json::object());
  for (const auto& [axis, rows] : extremes.items()) expect_split(axis, rows, stratum);
}

// Checks that the stratum has the campaign's lanes, and that only device lanes are compared with cpu lanes.
void expect_lanes(const Json& stratum, const std::vector<std::string>& lanes) {
  const Json& rows = stratum.at("lanes");
  for (const std::string& lane : lanes) {
    if (!rows.contains(lane) || rows.size() != lanes.size())
      throw Impossible("its lanes are not those of the campaign");
    if (rows[lane].at("differs_from_cpu").is_null() == is_compared_with_cpu(lane, lanes))
      throw Impossible(fmt::format("differs_from_cpu of {} is {}", lane, rows[lane]["differs_from_cpu"].dump()));
  }
}

// Checks that the signatures account for each wrong verdict: a pair has one signature for each subject that is wrong.
void expect_possible_signatures(const Json& summary, std::uint64_t pairs) {
  constexpr std::pair<char, std::uint64_t Counts::*> kMarks[] = {{'+', &Counts::false_positive},
                                                                 {'-', &Counts::false_negative},
                                                                 {'!', &Counts::crashed},
                                                                 {'@', &Counts::timed_out},
                                                                 {'%', &Counts::unstable}};
  std::set<std::string> keys;
  std::map<std::string, std::uint64_t> of_subjects;
  std::map<std::pair<std::string, char>, std::uint64_t> of_lanes;
  std::uint64_t all = 0, most = 0;
  for (const Json& row : summary.at("signatures")) {
    const std::string key = row.at("key");
    const std::uint64_t found = count(row, "count");
    const auto signature = analysis::parse_signature(key);
    if (!signature || !signature->wrong()) throw Impossible("expected the key of a signature, found " + shown(key));
    if (!keys.insert(key).second) throw Impossible("it has the signature " + shown(key) + " twice");
    expect(0 < found && found <= pairs, fmt::format("1 to {} pairs of the signature {}", pairs, shown(key)), found);
    all += found;
    most = std::max(most, of_subjects[signature->subject] += found);
    for (const analysis::WrongLane& wrong : signature->wrong_lanes)
      of_lanes[{signature->subject + '/' + wrong.lane, wrong.mark}] += found;
  }
  for (const std::string lane : summary.at("spec").at("lanes")) {
    Counts counts;
    std::uint64_t stored = 0;
    for (const Json& stratum : summary.at("strata")) {
      const Json& row = stratum.at("lanes").at(lane);
      counts += counts_of(row);
      if (row.contains("stored")) stored += count(row, "stored");
    }
    if (const Lane* row = find_lane(lane); row && row->exact)
      expect(counts.wrong() == stored, fmt::format("exactly {} wrong verdicts of {}", stored, lane), counts.wrong());
    for (const auto& [mark, field] : kMarks) {
      const std::uint64_t found = of_lanes[{lane, mark}];
      expect(found == counts.*field,
             fmt::format("exactly {} pairs marked '{}' of {} by signature", counts.*field, mark, lane), found);
    }
  }
  const std::uint64_t disagreements = count(summary, "disagreements");
  expect(most <= disagreements && disagreements <= std::min(all, pairs),
         fmt::format("{} to {} disagreements", most, std::min(all, pairs)), disagreements);
}

// Checks a summary without a database: counts must be within their limits, and sums must agree.
void expect_possible_summary(const Json& summary) {
  if (const std::uint64_t seed = count(summary.at("spec"), "seed"); seed > kMostWhole)
    throw Impossible(fmt::format("expected a seed up to 2^53, found {}", seed));
  for (const auto& [field, value] : summary.at("build").items()) {
    if (!value.is_string() && !value.is_null() && field != "executors")
      throw Impossible(fmt::format("expected a string as build's {}, found {}", field, value.dump()));
  }
  for (const char* field : {"version", "commit", "compiler"}) summary["build"].at(field).get_ref<const std::string&>();
  std::uint64_t pairs = 0;
  const std::vector<std::string> lanes = summary.at("spec").at("lanes");
  for (const std::string& lane : lanes) {
    if (!parse_lane_name(lane)) throw Impossible(shown(lane) + " is not the name of a lane");
  }
  std::vector<std::string> strata;
  for (const auto& [id, stratum] : summary.at("strata").items()) strata.push_back(id);
  if (strata != summary.at("spec").at("strata").get<std::vector<std::string>>())
    throw Impossible("its strata are not those of the campaign");
  for (const auto& [id, stratum] : summary.at("strata").items()) {
    try {
      expect_lanes(stratum, lanes);
      expect_possible(stratum);
    } catch (const Impossible& error) {
      throw Impossible(id + ": " + error.what());
    }
    pairs += count(stratum, "pairs");
  }
  const std::uint64_t all = count(summary.at("spec"), "pairs");
  const bool complete = summary.at("complete");
  expect(complete ? pairs == all : pairs <= all,
         fmt::format("{} {} pairs in all strata", complete ? "exactly" : "at most", all), pairs);
  expect_possible_signatures(summary, pairs);
}

// The summary computed from the sums over the store's rows.
Json summary_of_database(const fs::path& directory) {
  const auto [store, of_source, pairs] = counts_of_database(directory);
  StoredCounts all(static_cast<int>(store.lanes.size()));
  for (const StoredCounts& counts : of_source) all.add(counts);
  return summary_of(store, of_source, all.signatures, all.executor_mismatches, pairs == store.spec.at("pairs"));
}

}  // namespace

DatabaseCounts counts_of_database(const fs::path& directory) {
  DatabaseCounts found{recorded_store(directory), {}};
  StoreSpec& store = found.store;
  for (const std::string id : store.spec.at("strata")) {
    // How many pairs a mesh has is known only from the mesh, so this checks only that no source has more pairs than the
    // campaign.
    strata::PairSource source{id, store.spec.at("pairs"), nullptr};
    if (!store.spec.contains("scene")) source.axis = strata::axis_of(id);
    store.sources.push_back(std::move(source));
    found.of_source.emplace_back(static_cast<int>(store.lanes.size()));
  }
  for_each_row(store, [&](const PairRange& range, const StoredCounts& counts) {
    found.of_source[static_cast<std::size_t>(range.source)].add(counts);
    found.pairs += range.pairs;
  });
  return found;
}

bool has_database(const fs::path& directory) { return fs::exists(directory / kDatabase); }

Json checked_summary(const fs::path& directory) {
  const fs::path file = directory / "summary.json";
  const std::string text = read_whole(file);
  if (text.empty())
    throw std::runtime_error(cannot("open", directory, "it is not a campaign directory: it has no summary.json"));
  const Json summary = parse_shallow(text);
  try {
    if (!summary.is_object()) throw corpus::FormatError(cannot("use", file, "it is not the summary of a campaign"));
    if (has_database(directory)) {
      const Json expected = summary_of_database(directory);
      if (summary != expected)
        throw Impossible(fmt::format("it contradicts {}: {}; run the command that began the campaign to write it again",
                                     kDatabase, first_difference(expected, summary)));
    } else {
      expect_possible_summary(summary);
    }
  } catch (const Impossible& error) {
    throw std::runtime_error(cannot("use", file, error.what()));
  } catch (const Json::exception&) {
    throw corpus::FormatError(cannot("use", file, "it is not the summary of a campaign"));
  }
  return summary;
}

Json recorded_spec(const fs::path& directory) {
  if (has_database(directory)) return recorded_store(directory).spec;
  const Json summary = parse_shallow(read_whole(directory / "summary.json"));
  const Json spec = summary.is_object() ? summary.value("spec", Json()) : Json();
  return spec.is_object() ? spec : Json();
}

}  // namespace graze::fuzz
