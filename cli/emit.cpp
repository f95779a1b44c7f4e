// SPDX-License-Identifier: Apache-2.0
#include "cli/emit.h"

#include <fmt/format.h>

#include <optional>

#include "analysis/signature.h"
#include "cli/cases.h"
#include "cli/commands.h"
#include "oracle/truth.h"

namespace graze {
namespace {

// Where the case is from: its numbers, or those it was minimised from, its name, or its line.
std::string origin(const std::string& name, const Entry& entry) {
  if (const std::optional<std::string> numbers = numbers_of(entry)) return *numbers;
  const std::string *kind = field(entry, "kind"), *from = field(entry, "from"), *label = field(entry, "name");
  if (kind && from) return fmt::format("{} from {}", *kind, *from);
  return label ? *label : entry.line > 0 ? fmt::format("{}:{}", name, entry.line) : name;
}

std::string described(const std::string& name, const Entry& entry, const Truth& t) {
  return fmt::format("Case {}: contact {}, margin {} ({} ulps)", origin(name, entry), graze::name(t.contact), t.margin,
                     t.margin_ulps);
}

}  // namespace

std::string emit(SnippetKind kind, const std::string& name, const std::vector<Entry>& entries, const Bench& bench) {
  std::optional<SnippetCase> fallback;
  for (const Entry& entry : entries) {
    const Truth t = truth(entry.pair);
    if (t.verdict == Verdict::declined) continue;
    const SnippetCase found{described(name, entry, t), entry.pair, t.verdict, nullptr, t.verdict};
    const std::vector<Verdict> verdicts = decide(bench, entry.pair);
    const std::string* signature = field(entry, "signature");
    std::optional<std::size_t> wrong;
    for (std::size_t l = 0; l < bench.lanes.size(); ++l) {
      if (verdicts[l] == t.verdict || (shows_lanes(kind) && !shows(kind, *bench.lanes[l]))) continue;
      const bool is_recorded = signature && bench.lanes[l]->info->id == algorithm_of(*signature);
      if (!wrong || (is_recorded && bench.lanes[*wrong]->info != bench.lanes[l]->info)) wrong = l;
    }
    if (wrong) return snippet(kind, {found.name, found.pair, found.truth, bench.lanes[*wrong], verdicts[*wrong]});
    if (!fallback) fallback = found;
  }
  if (!fallback) throw std::runtime_error(name + ": expected a case with finite coordinates, found none");
  if (!shows_lanes(kind)) return snippet(kind, *fallback);
  throw std::runtime_error(fmt::format("{}: expected a case on which one of the {} lanes is wrong, found none", name,
                                       kind == SnippetKind::cuda ? "CUDA" : "CPU"));
}

}  // namespace graze
