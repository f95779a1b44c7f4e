// SPDX-License-Identifier: Apache-2.0
// `graze dump`: writes the pairs of a stratum or a campaign with their truth, as a file of pairs or a table.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iostream>

#include "analysis/discrepancy.h"
#include "analysis/sweep.h"
#include "cli/cases.h"
#include "cli/commands.h"
#include "core/cannot.h"
#include "core/error.h"
#include "core/text.h"
#include "corpus/pair_format.h"
#include "fuzz/campaign/checked_summary.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/campaign/result_files.h"
#include "strata/pair_source.h"

namespace graze::cli {

using fuzz::Json;
namespace {

namespace fs = std::filesystem;

enum class Format { pairs, csv };

struct DumpOptions {
  std::string name;
  Format format = Format::csv;
  std::uint64_t pairs = 0;  // 0: 1000 pairs of a stratum, all pairs of a campaign
  LaneOptions lanes;
  std::vector<std::string> values;  // two lanes
};

// STRATUM or STRATUM:SEED; the stratum may be a pattern.
CampaignPairs of_stratum(const DumpOptions& options) {
  const std::size_t colon = std::min(options.name.find(':'), options.name.size());
  CampaignPairs dumped;
  if (colon < options.name.size()) {
    const std::string seed = options.name.substr(colon + 1);
    const std::optional<std::uint64_t> value = parse_whole(seed);
    if (!value || *value > kMostWhole)
      throw UsageError(fmt::format("expected STRATUM:SEED, found '{}' as the seed", printable(seed)));
    dumped.seed = *value;
  }
  const std::string stratum = options.name.substr(0, colon);
  dumped.sources = strata::stratum_sources(dumped.seed, options.pairs > 0 ? options.pairs : 1000, {stratum},
                                           strata::stratum_in_doubles(stratum) ? PairTypes::f64 : PairTypes::f32);
  return dumped;
}

CampaignPairs drawn_for(const DumpOptions& options) {
  const std::string stratum = options.name.substr(0, options.name.find(':'));
  const bool is_path = fs::is_directory(options.name) ||
                       (options.name.find('/') != std::string::npos && !strata::stratum_in_doubles(stratum));
  if (!is_path) return of_stratum(options);
  CampaignPairs pairs = pairs_of_campaign(options.name, options.pairs, "dump");
  if (const std::uint64_t all = analysis::pairs_in(pairs.sources); all < options.pairs)
    fmt::print(stderr, "graze: {} has only {} of the {} requested pairs\n", printable(options.name), all,
               options.pairs);
  return pairs;
}

// Returns the lane's name as a field key, such as moller_1997.f32.cpu.
std::string key_of(const Lane& lane) {
  std::string key = lane.id;
  for (char& c : key) c = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' ? c : '.';
  return key;
}

void print_header(Format format, const std::vector<const Lane*>& lanes) {
  if (format == Format::pairs) return corpus::write_header(std::cout);
  std::cout << "stratum,seed,index";
  for (int i = 0; i < kCoordinates; ++i) std::cout << ',' << (i < 9 ? 'a' : 'b') << i / 3 % 3 << "xyz"[i % 3];
  std::cout << ",truth,contact,margin,margin_ulps";
  for (const Lane* lane : lanes) std::cout << ',' << lane->id;
  std::cout << '\n';
}

void print_row(Format format, const corpus::Entry& entry) {
  if (format == Format::pairs) return corpus::write_entry(std::cout, entry);
  for (int i = 0; i < 3; ++i) std::cout << (i > 0 ? "," : "") << entry.fields[static_cast<std::size_t>(i)].second;
  // The shortest decimal whose nearest double is the coordinate.
  const DoublePair pair = entry.doubles.value_or(in_doubles(entry.pair));
  for (int i = 0; i < kCoordinates; ++i) std::cout << ',' << fmt::format("{}", coordinates(pair)[i]);
  for (std::size_t i = 3; i < entry.fields.size(); ++i) std::cout << ',' << entry.fields[i].second;
  std::cout << '\n';
}

void dump(const DumpOptions& options) {
  fuzz::SelectedLanes under_test;
  LaneOptions lanes = options.lanes;
  if (lanes.globs.empty()) lanes.globs = with_subjects({}, lanes);
  if (lanes.globs.empty()) expect_own_code_among(lanes, {}, "--lanes");
  if (!lanes.globs.empty()) under_test = selected_lanes(lanes, options.name);
  const CampaignPairs dumped = drawn_for(options);
  if (analysis::any_in_doubles(dumped.sources) && !under_test.lanes.empty()) take_doubles(under_test);
  print_header(options.format, under_test.lanes);
  for (const strata::PairSource& source : dumped.sources) {
    for (std::uint64_t index = 0; index < source.pairs && std::cout; ++index) {
      const std::vector<std::pair<std::string, std::string>> numbers = {
          {"stratum", source.id}, {"seed", std::to_string(dumped.seed)}, {"index", std::to_string(index)}};
      corpus::Entry entry = corpus::entry_of(source.any_pair(index), numbers);
      if (!dumped.scene.empty() && options.format == Format::pairs) entry.fields.emplace_back("scene", dumped.scene);
      for (auto& field : fuzz::truth_fields(truth_of(entry))) entry.fields.push_back(std::move(field));
      if (!under_test.lanes.empty()) {
        const std::vector<Verdict> verdicts = decide(under_test, corpus::pair_of(entry));
        for (std::size_t l = 0; l < verdicts.size(); ++l)
          entry.fields.emplace_back(key_of(*under_test.lanes[l]), name(verdicts[l]));
      }
      print_row(options.format, entry);
    }
  }
}

analysis::LanesCompared compared_lanes(const std::vector<std::string>& ids) {
  if (ids.size() != 2) throw UsageError("--values takes two lanes, separated by a comma");
  return {published_lane(ids[0]), published_lane(ids[1])};
}

// For each pair, writes one row with both lanes' verdicts and branch choices, and one row for each value that at least
// one lane compares. Numbers are hexadecimal.
void dump_values(const DumpOptions& options) {
  const analysis::LanesCompared lanes = compared_lanes(options.values);
  const std::vector<Question>& questions = questions_of(lanes.first->algorithm);
  const CampaignPairs dumped = drawn_for(options);
  if (lanes.first->scalar == Scalar::f32) strata::expect_float32(dumped.sources, "dump --values");
  std::cout << "stratum,seed,index,question,value,first,second,compared,exact_high,exact_low,bound,rounding\n";
  const auto number = [](const std::optional<double>& x) { return x ? fmt::format("{:a}", *x) : ""; };
  for (const strata::PairSource& source : dumped.sources) {
    for (std::uint64_t index = 0; index < source.pairs && std::cout; ++index) {
      const AnyPair pair = source.any_pair(index);
      if (!is_finite(pair.doubles)) continue;
      const analysis::RunsBeside runs = analysis::runs_beside(lanes, pair);
      const std::string place = fmt::format("{},{},{}", source.id, dumped.seed, index);
      std::cout << fmt::format("{},,,{} {:x},{} {:x},,,,,\n", place, name(recorded_verdict(runs.first.path)),
                               runs.first.path & kChoices, name(recorded_verdict(runs.second.path)),
                               runs.second.path & kChoices);
      for (const analysis::ValueBeside& value : runs.values) {
        const Question& question = questions[static_cast<std::size_t>(value.question)];
        std::cout << fmt::format("{},\"{}\",\"{}\",{},{},{},", place, question.name,
                                 question.of[static_cast<std::size_t>(value.which)], number(value.first),
                                 number(value.second), value.compared ? 1 : 0);
        if (value.unrounded) {
          const auto& [exact, rounding] = *value.unrounded;
          std::cout << fmt::format("{:a},{:a},{:a},{:a}\n", exact.hi, exact.lo, exact.bound, rounding);
        } else {
          std::cout << ",,,\n";
        }
      }
    }
  }
}

}  // namespace

CampaignPairs pairs_of_campaign(const std::string& directory, std::uint64_t most, const char* verb) {
  CampaignPairs pairs;
  pairs.summary = fuzz::checked_summary(directory);
  try {
    const Json& spec = pairs.summary.at("spec");
    if (spec.contains("hunt"))
      throw std::runtime_error(
          cannot(verb, directory, "the pairs of a hunt cannot be drawn again; those that it kept are in its cases/"));
    pairs.seed = spec.at("seed");
    if (spec.contains("scene")) pairs.scene = spec["scene"].at("name");
    pairs.sources = fuzz::recorded_sources(spec);
  } catch (const Json::exception&) {
    throw std::runtime_error(cannot("use", directory + "/summary.json", "it is not the summary of a campaign"));
  }
  if (most > 0) {  // every source gets the same share; the first sources also get the remainder
    for (std::size_t s = 0; s < pairs.sources.size(); ++s) {
      const std::uint64_t share = most / pairs.sources.size() + (s < most % pairs.sources.size());
      pairs.sources[s].pairs = std::min(pairs.sources[s].pairs, share);
    }
  }
  return pairs;
}

void add_dump(CLI::App& app, int&) {
  CLI::App* command = app.add_subcommand(
      "dump", "Write the pairs of a stratum or a campaign, with truth, contact and margin, for other programs");
  command->footer("Example: graze dump near_edge_edge:1 --pairs 100 --lanes '*/f32/cpu'");
  auto options = std::make_shared<DumpOptions>();
  command
      ->add_option("SOURCE", options->name, "Stratum, STRATUM:SEED (the seed is 1 by default), or campaign directory")
      ->required();
  static_assert(static_cast<int>(Format::pairs) == 0 && static_cast<int>(Format::csv) == 1);
  add_valued(*command, "--format", options->format, "pairs|csv",
             "Format of the output. csv: a table with a header line; its decimals give the exact coordinates "
             "when they are read as doubles. pairs: the format that `graze check` reads")
      ->transform(one_of({"pairs", "csv"}, Chosen::place))
      ->default_str("csv");
  add_valued(*command, "--pairs", options->pairs, "N",
             "Number of pairs in total; by default 1000 for a stratum, all for a campaign")
      ->transform(whole_number(1, kMostWhole));
  add_lane_options(*command, options->lanes);
  command->get_option("--lanes")
      ->description("Patterns of the lanes whose verdicts are added")
      ->default_str("those of --subject");
  add_resubject_option(*command, options->lanes);
  add_globs(*command, "--values", options->values,
            "Two lanes of one algorithm and scalar, whose compared values are written beside the exact ones")
      ->option_text("LANE,LANE")
      ->excludes("--lanes")
      ->excludes("--subject")
      ->excludes("--format");
  command->callback([options] {
    const LaneOptions& lanes = options->lanes;
    if (lanes.executor != fuzz::Executor::automatic && lanes.globs.empty() && lanes.subjects.empty())
      throw UsageError("--executor is for lanes whose verdicts are added; name them with --lanes");
    options->values.empty() ? dump(*options) : dump_values(*options);
  });
}

}  // namespace graze::cli
