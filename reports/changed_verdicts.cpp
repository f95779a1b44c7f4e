// SPDX-License-Identifier: Apache-2.0
#include "reports/comparison.h"

#include <fmt/format.h>

#include <set>
#include <stdexcept>

#include "core/text.h"
#include "reports/discrepancy_reading.h"
#include "reports/terminal.h"

namespace graze::reports {

using Json = nlohmann::ordered_json;
namespace {

// The name of a case. Leaves out the coordinates, because compare.json has them.
std::string place_of(const std::string& text) { return text.substr(0, text.find(' ')); }

// The totals in the headline: how many verdicts changed, and in which lanes.
struct ChangedTotals {
  std::uint64_t lanes = 0, verdicts = 0, least = 0, most = 0, broken = 0, mended = 0, unknown_most = 0;
  std::set<std::string> changed, unknown;
  bool counted = true;  // whether the number of changed verdicts is exact
};

ChangedTotals totals_of(const Json& verdicts) {
  ChangedTotals totals;
  std::set<std::string> lanes;
  for (const Json& row : verdicts) {
    lanes.insert(row.at("lane"));
    totals.verdicts += row.at("pairs").get<std::uint64_t>();
    const std::uint64_t least = row.at("least"), most = row.at("most");
    if (row.at("known") == "same" || most == 0) continue;
    const bool counted = row.contains("broken");
    if (row.at("known") == "unknown" && !counted) {
      totals.unknown.insert(row.at("lane"));
      totals.unknown_most += most;
      continue;
    }
    totals.changed.insert(row.at("lane"));
    totals.counted &= counted;
    totals.least += least;
    totals.most += most;
    totals.broken += row.value("broken", std::uint64_t{0});
    totals.mended += row.value("mended", std::uint64_t{0});
  }
  totals.lanes = lanes.size();
  return totals;
}

}  // namespace

std::string paired_headline(const Json& verdicts) {
  const ChangedTotals totals = totals_of(verdicts);
  const std::string unknown =
      totals.unknown.empty()
          ? ""
          : fmt::format("; changes in {} are not known, because a GPU engine judged their pairs (at most {} changed)",
                        counted(totals.unknown.size(), "lane"), counted(totals.unknown_most, "verdict"));
  if (totals.changed.empty())
    return unknown.empty() ? fmt::format("Nothing changed: all {} of {} are the same, pair by pair",
                                         counted(totals.verdicts, "verdict"), counted(totals.lanes, "lane"))
                           : "No change was found" + unknown;
  const std::string lanes = fmt::format("of {} of {}", grouped(totals.changed.size()), counted(totals.lanes, "lane"));
  if (!totals.counted)
    return fmt::format("Changed: at least {} {}, and at most {}{}", counted(totals.least, "verdict"), lanes,
                       grouped(totals.most), unknown);
  const std::uint64_t otherwise = totals.most - totals.broken - totals.mended;
  return fmt::format("Changed: {} {}: {} became wrong, {} no longer wrong{}{}", counted(totals.most, "verdict"), lanes,
                     grouped(totals.broken), grouped(totals.mended),
                     otherwise == 0 ? "" : fmt::format(", {} changed otherwise", grouped(otherwise)), unknown);
}

void expect_possible_changes(const Json& verdicts, std::uint64_t campaign) {
  for (const Json& row : verdicts) {
    const std::uint64_t pairs = row.at("pairs"), least = row.at("least"), most = row.at("most");
    const std::uint64_t counted = row.value("broken", std::uint64_t{0}) + row.value("mended", std::uint64_t{0});
    const Json& known = row.at("known");
    if (pairs > campaign || least > most || most > pairs || counted > most ||
        (known != "same" && known != "changed" && known != "unknown") || (known == "same" && most > 0))
      throw std::runtime_error(fmt::format("it has impossible counts of changed verdicts: {}", shown(row.dump())));
  }
}

std::vector<std::string> changed_sentences(const Json& compare) {
  std::vector<std::string> sentences;
  std::size_t more = 0;
  const Json rows = compare.value("verdicts", Json());
  const std::set<std::string> lanes = totals_of(rows).changed;
  for (const Json& rate : compare.value("rates", Json::array())) {
    if (rate.at("stratum") == kAllStrata && lanes.contains(text_at(rate, "lane")))
      sentences.push_back(fmt::format("{}: wrong on {} of {} before, on {} after.", text_at(rate, "lane"),
                                      grouped(number_at(rate.at("before"), "count")),
                                      counted(number_at(rate.at("before"), "of"), "pair"),
                                      grouped(number_at(rate.at("after"), "count"))));
  }
  const std::size_t most_sentences = sentences.size() + kMostChanged;
  for (const Json& row : rows) {
    const std::uint64_t least = row.at("least"), most = row.at("most");
    if (row.at("known") == "same" || most == 0) continue;
    if (sentences.size() == most_sentences) {
      ++more;
      continue;
    }
    std::string text = fmt::format("{}, {}: ", text_at(row, "lane"), text_at(row, "stratum"));
    const std::string of = fmt::format("of {}", counted(row.at("pairs").get<std::uint64_t>(), "verdict"));
    if (row.contains("broken")) {
      text += fmt::format("{} {} changed", grouped(most), of);
      for (const auto& [way, now] : {std::pair("broken", "became wrong"), {"mended", "no longer wrong"}}) {
        const std::string smallest = std::string("smallest_") + way;
        text += fmt::format(
            "; {} {}{}", grouped(row.at(way)), now,
            row.contains(smallest) ? fmt::format(" (smallest: {})", place_of(text_at(row, smallest.c_str()))) : "");
      }
    } else if (row.at("known") == "changed") {
      text += fmt::format("by the counts, at least {} and at most {} {} changed; it is not known which", grouped(least),
                          grouped(most), of);
    } else {
      text += fmt::format("at most {} {} changed, perhaps none; the GPU engine keeps only counts", grouped(most), of);
    }
    sentences.push_back(text + ".");
  }
  if (more > 0) sentences.push_back(fmt::format("{} more lanes and strata are in compare.json.", grouped(more)));
  return sentences;
}

}  // namespace graze::reports
