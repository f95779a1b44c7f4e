// SPDX-License-Identifier: Apache-2.0
// `graze failures`: groups a campaign's failures by kind.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>

#include "analysis/explain.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/screen.h"
#include "fuzz/campaign/checked_summary.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/minimise/kinds.h"
#include "reports/own_code.h"
#include "reports/terminal.h"
#include "reports/text_table.h"

namespace graze::cli {
namespace {

using fuzz::Json;

// Returns lane ids without their subject, such as "f32/cpu f32/cpu-fma".
std::string lanes_within(const Json& lanes, const std::string& subject) {
  std::string names;
  for (const Json& id : lanes) names += (names.empty() ? "" : " ") + id.get<std::string>().substr(subject.size() + 1);
  return names;
}

// Returns shares such as "near_edge_edge 70 %, uniform 30 %", largest first.
std::string shares(const Json& counts, std::size_t most) {
  std::vector<std::pair<std::string, std::uint64_t>> rows;
  double sum = 0;
  for (const auto& [name, count] : counts.items()) {
    rows.emplace_back(name, count.get<std::uint64_t>());
    sum += static_cast<double>(rows.back().second);
  }
  std::stable_sort(rows.begin(), rows.end(), [](const auto& l, const auto& r) { return l.second > r.second; });
  std::string text;
  for (std::size_t i = 0; i < std::min(most, rows.size()); ++i) {
    const double percent = 100 * static_cast<double>(rows[i].second) / sum;
    text += fmt::format("{}{} {}", i == 0 ? "" : ", ", rows[i].first,
                        percent < 0.5 ? "under 1 %" : fmt::format("{:.0f} %", percent));
  }
  return text + (rows.size() > most ? fmt::format(", {} more", rows.size() - most) : "");
}

// Describes a kind: title, sentence, how often it occurs, and its simplest case; with `all`, also where it occurs.
std::string kind_text(const Json& kind, std::size_t number, bool all, const reports::Screen& screen) {
  const auto line = [&](int indent, const std::string& text) {
    return reports::wrapped(text, screen.columns, indent, indent + 2);
  };
  const std::string subject = kind["subject"], file = kind["simplest"]["case"], errors = reports::errors_words(kind);
  const std::string title = fmt::format("kind-{}  {}: {}, {} pairs", number, subject, reports::cause_words(kind),
                                        kind["shape"].get<std::string>());
  std::string text = reports::bold(screen, line(0, title));
  const Json& sentences = kind["simplest"]["sentences"];
  for (std::size_t i = 0; i < sentences.size(); ++i) {
    const std::string sentence = sentences[i];
    if (i == 0 || analysis::tells_difference_from_cpu(sentence)) text += line(2, sentence);
  }
  text += line(2, fmt::format("{} of {}, each signature classified by one pair{}; wrong: {}; simplest: {}",
                              reports::counted(kind["pairs"].get<std::uint64_t>(), "pair"),
                              reports::counted(kind["signatures"].get<std::uint64_t>(), "signature"),
                              errors.empty() ? "" : ", " + errors, lanes_within(kind["lanes"], subject), file));
  if (!all) return text;
  const std::uint64_t settled = kind["settled"][0], of = kind["settled"][1];
  if (settled < of) text += line(2, fmt::format("the cause is settled for {} of {} examined lanes", settled, of));
  text += line(2, "margins: " + shares(kind["margins"], 4));
  if (!kind["strata"].empty()) text += line(2, "strata of the kept pairs: " + shares(kind["strata"], 4));
  return text +
         line(2, fmt::format("worst: {:.4g} ulps, in {} (from {})", kind["worst"]["margin_ulps"].get<double>(),
                             kind["worst"]["case"].get<std::string>(), kind["worst"]["from"].get<std::string>()));
}

// For each cause, prints how many of the examined lanes passed the audit (analysis/audit.h).
void print_audit(const Json& kinds, const reports::Screen& screen) {
  std::map<std::string, std::array<std::uint64_t, 2>> of_cause;
  for (const Json& kind : kinds) {
    auto& sum = of_cause[kind.at("cause")];
    for (std::size_t i = 0; i < 2; ++i) sum[i] += kind.at("settled").at(i).get<std::uint64_t>();
  }
  reports::TextTable table({{"cause", reports::Align::left}, {"lanes audited"}, {"settled"}, {"not settled"}});
  for (const auto& [cause, sum] : of_cause) {
    if (sum[1] > 0)
      table.add({cause, reports::grouped(sum[1]), reports::grouped(sum[0]), reports::grouped(sum[1] - sum[0])});
  }
  fmt::print("{}", table.text(screen));
}

int kinds_of(const std::string& directory, bool json, bool all) {
  const Json summary = fuzz::checked_summary(directory);
  const std::atomic<bool>& interrupted = catch_interrupts();
  const Json kinds = fuzz::kinds_of(directory, summary, [&] { return interrupted.load(); });
  if (interrupted) {
    fmt::print(stderr, "graze: interrupted; wrote nothing\n");
    return kInterrupted;
  }
  const reports::Screen screen = output_screen();
  if (json) {
    for (const Json& kind : kinds) fmt::print("{}\n", kind.dump());
    return 0;
  }
  if (summary["signatures"].empty()) fmt::print("no failures\n");
  constexpr int kLinesAtTheEnd = 5;
  LimitedText limited(all ? std::numeric_limits<int>::max() : kMostLines - kLinesAtTheEnd);
  double told = 0, sum = 0;
  std::size_t shown = 0;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const double pairs = kinds.at(i).at("pairs").get<double>();
    sum += pairs;
    if (!limited.add(kind_text(kinds.at(i), i + 1, all, screen))) continue;
    told += pairs;
    ++shown;
  }
  fmt::print("{}", limited.text());
  if (shown < kinds.size())
    print_wrapped(
        {fmt::format("and {} rarer kinds with {:.1f} % of the failures (a pair may have several); --all lists "
                     "them, and where each kind occurs",
                     kinds.size() - shown, 100 * (1 - told / sum))});
  if (const std::size_t without = fuzz::signatures_without_kind(summary, kinds); without > 0)
    print_wrapped(
        {fmt::format("{} of {} signatures belong to no kind: their lanes were not examined, run only on a "
                     "device, or did not fail again",
                     without, summary["signatures"].size())});
  if (!kinds.empty() && all) {
    fmt::print("\n");
    print_audit(kinds, screen);
  }
  return 0;
}

}  // namespace

void add_failures(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand("failures", "List the kinds of failure that a campaign found");
  command->footer("Example: graze failures campaign");
  auto directory = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false), all = std::make_shared<bool>(false);
  command->add_option("DIR", *directory, "Campaign directory, best after `graze minimize`")->required();
  command->add_flag("--json", *json, "Print one JSON object per line, described in docs/formats.md");
  command->add_flag("--all", *all, "List all kinds, where each occurs, and how many causes are settled");
  command->callback([directory, json, all, &status] { status = kinds_of(*directory, *json, *all); });
}

}  // namespace graze::cli
