// SPDX-License-Identifier: Apache-2.0
#include "reports/junit.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "analysis/signature.h"
#include "core/simplify/simplicity.h"
#include "core/text.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/minimise/kinds.h"
#include "reports/counts.h"
#include "reports/plain_figures.h"
#include "reports/terminal.h"

namespace graze::reports {

using fuzz::Json;
namespace {

namespace fs = std::filesystem;

std::string in_xml(std::string_view text) {
  std::string escaped;
  for (const char c : text) escaped += c == '\n' ? "&#10;" : html(printable(std::string_view(&c, 1)));
  return escaped;
}

std::string case_in_xml(const JunitCase& test) {
  const std::string begin =
      fmt::format("    <testcase classname=\"{}\" name=\"{}\"", in_xml(test.suite), in_xml(test.name));
  if (!test.skipped.empty())
    return begin + fmt::format(">\n      <skipped message=\"{}\"/>\n    </testcase>\n", in_xml(test.skipped));
  if (test.failure.empty()) return begin + "/>\n";
  return begin + fmt::format(">\n      <failure message=\"{}\">{}</failure>\n    </testcase>\n",
                             in_xml(test.failure.substr(0, test.failure.find('\n'))), in_xml(test.failure));
}

// The simplest kept pair on which a lane is wrong, and its file.
struct Kept {
  Simplicity simplicity;  // equal for all pairs of doubles, so the first one is kept
  std::string pair;
  fs::path file;
};

// The kept pairs by lane and stratum. An empty stratum means all strata.
std::map<std::pair<std::string, std::string>, Kept> simplest_of(const fs::path& directory, const Json& summary) {
  std::map<std::pair<std::string, std::string>, Kept> simplest;
  for (const Json& row : summary["signatures"]) {
    const auto signature = analysis::parse_signature(row["key"].get<std::string>());
    if (!signature) continue;
    for (const corpus::Entry& entry : fuzz::read_cases(directory, summary["spec"], row)) {
      const std::string* stratum = corpus::field(entry, "stratum");
      if (!stratum) continue;  // a minimised pair, which no stratum drew
      const AnyPair pair = corpus::pair_of(entry);
      const Kept kept{simplicity(pair), fuzz::pair_text(pair), fuzz::case_file(directory, row)};
      for (const analysis::WrongLane& lane : signature->wrong_lanes) {
        if (lane.mark == '?') continue;  // declined, which is not wrong
        for (const std::string& of : {*stratum, std::string()}) {
          const auto [place, is_new] = simplest.try_emplace({signature->subject + '/' + lane.lane, of}, kept);
          if (!is_new && kept.simplicity < place->second.simplicity) place->second = kept;
        }
      }
    }
  }
  return simplest;
}

}  // namespace

std::string junit(std::span<const JunitCase> cases) {
  std::string text = "<testsuites name=\"graze\">\n";  // identifies our own files (fuzz/own_files.h)
  for (auto first = cases.begin(); first != cases.end();) {
    const auto last =
        std::find_if(first, cases.end(), [&](const JunitCase& test) { return test.suite != first->suite; });
    const auto failures = std::count_if(first, last, [](const JunitCase& test) { return !test.failure.empty(); });
    const auto skipped = std::count_if(first, last, [](const JunitCase& test) { return !test.skipped.empty(); });
    text += fmt::format("  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"{}\">\n",
                        in_xml(first->suite), last - first, failures, skipped);
    for (; first != last; ++first) text += case_in_xml(*first);
    text += "  </testsuite>\n";
  }
  return text + "</testsuites>\n";
}

std::vector<JunitCase> junit_of_campaign(const fs::path& directory, const Json& summary,
                                         std::span<const fuzz::LaneLeftOut> left_out) {
  const CampaignCounts counts = counts_of(summary);
  const auto simplest = simplest_of(directory, summary);
  std::vector<JunitCase> cases;
  for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
    const std::string& lane = counts.lanes[l].id;
    for (const std::size_t s : counts.drawn()) {
      const StratumCounts& stratum = counts.strata[s];
      JunitCase& test = cases.emplace_back(JunitCase{lane, stratum.id, "", ""});
      if (stratum.wrong(l) == 0) continue;
      auto kept = simplest.find({lane, stratum.id});
      if (kept == simplest.end()) kept = simplest.find({lane, ""});
      test.failure = fmt::format("wrong on {} of {}", grouped(stratum.wrong(l)), counted(stratum.pairs, "pair"));
      if (kept == simplest.end()) continue;
      test.failure += fmt::format(", such as {0}\nAgain: graze repro {1}\nWhy: graze explain {1}", kept->second.pair,
                                  path_word(kept->second.file.string()));
    }
  }
  for (const fuzz::LaneLeftOut& lane : left_out) cases.push_back({lane.id, "all strata", "", lane.why});
  return cases;
}

}  // namespace graze::reports
