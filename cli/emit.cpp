// SPDX-License-Identifier: Apache-2.0
#include "cli/emit.h"

#include <fmt/format.h>

#include <optional>

#include "analysis/convention.h"
#include "analysis/signature.h"
#include "cli/cases.h"
#include "cli/commands.h"
#include "oracle/truth.h"

namespace graze::cli {
namespace {

std::string described(const std::string& name, const corpus::Entry& entry, const oracle::Truth& t) {
  return fmt::format("Case {}: contact {}, margin {} ({} ulps)", shown_name(name, entry), graze::name(t.contact),
                     t.margin, t.margin_ulps);
}

}  // namespace

std::string emit(reports::SnippetKind kind, const std::string& name, const std::vector<corpus::Entry>& entries,
                 const fuzz::SelectedLanes& under_test) {
  std::optional<reports::SnippetCase> fallback;
  for (const corpus::Entry& entry : entries) {
    const oracle::Truth t = truth_of(entry);
    if (t.verdict == Verdict::declined) continue;
    const reports::SnippetCase found{described(name, entry, t), corpus::pair_of(entry), t.verdict, nullptr, t.verdict};
    const std::vector<Verdict> verdicts = decide(under_test, corpus::pair_of(entry));
    const std::vector<Verdict> counted = analysis::excused(under_test.lanes, verdicts, corpus::pair_of(entry), t);
    const std::string* signature = corpus::field(entry, "signature");
    std::optional<std::size_t> wrong;
    for (std::size_t l = 0; l < under_test.lanes.size(); ++l) {
      if (counted[l] == t.verdict || (reports::shows_lanes(kind) && !reports::shows(kind, *under_test.lanes[l])))
        continue;
      const bool is_recorded = signature && under_test.lanes[l]->info->id == analysis::subject_of(*signature);
      if (!wrong || (is_recorded && under_test.lanes[*wrong]->info != under_test.lanes[l]->info)) wrong = l;
    }
    if (wrong)
      return reports::snippet(kind, {found.name, found.pair, found.truth, under_test.lanes[*wrong], verdicts[*wrong]});
    if (!fallback) fallback = found;
  }
  if (!fallback) throw std::runtime_error("there is no pair with finite coordinates in " + name);
  if (!reports::shows_lanes(kind)) return reports::snippet(kind, *fallback);
  throw std::runtime_error(
      fmt::format("none of the {} lanes that a program can show is wrong on any pair of {}; choose other --lanes",
                  kind == reports::SnippetKind::cuda ? "CUDA" : "CPU", name));
}

}  // namespace graze::cli
