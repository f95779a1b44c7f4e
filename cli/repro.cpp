// SPDX-License-Identifier: Apache-2.0
// `graze repro`: a stored case, or a pair named by its three numbers, run again on every lane and on the oracle.
#include <fmt/format.h>

#include <charconv>
#include <iostream>

#include "analysis/signature.h"
#include "cli/commands.h"
#include "core/error.h"
#include "corpus/pair_format.h"
#include "fuzz/source.h"
#include "oracle/truth.h"
#include "reports/terminal.h"

namespace graze {
namespace {

std::uint64_t whole_number(std::string_view text, const std::string& name) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || text.empty())
    throw UsageError(name + ": expected a whole number, found '" + std::string(text) + "'");
  return value;
}

// STRATUM:SEED:INDEX, or a file of cases.
std::vector<Entry> cases_of(const std::string& name) {
  const std::size_t first = name.find(':'), last = name.rfind(':');
  if (first == std::string::npos || first == last || name.find('/') != std::string::npos) return read_pairs(name);
  const std::uint64_t seed = whole_number(std::string_view(name).substr(first + 1, last - first - 1), name);
  const std::uint64_t index = whole_number(std::string_view(name).substr(last + 1), name);
  return {{stratum_sources(seed, 1, {name.substr(0, first)}).front().pair(index), {}, 0}};
}

// Whether two signatures are equal, up to lanes that ran only once: every lane that ran then and runs now gives the
// recorded answer; '_' stands for one that did not run.
bool same_marks(const std::string& recorded, const std::string& now) {
  if (recorded.size() != now.size()) return false;
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (recorded[i] != now[i] && recorded[i] != '_' && now[i] != '_') return false;
  }
  return true;
}

// Prints the pair's signatures, and whether the recorded one still holds.   Returns: whether it changed.
bool compare_signatures(const Entry& entry, const Truth& t, std::span<const Lane* const> run,
                        std::span<const Verdict> verdicts) {
  const std::string* recorded = field(entry, "signature");
  const Shape hulls = shape(entry.pair);
  const Bucket bucket = margin_bucket(entry.pair, t.verdict);
  bool found = recorded == nullptr;
  for_each_algorithm(run, [&](std::size_t first, std::size_t count) {
    const Signature failure =
        signature(t.contact, hulls, bucket, t.verdict, run.subspan(first, count), verdicts.subspan(first, count));
    if (!failure.wrong()) return;
    const std::string now = key(failure);
    const bool same = recorded && same_marks(*recorded, now);
    found = found || same;
    std::cout << "  signature: " << now << (same ? "  (as recorded)" : "") << '\n';
  });
  if (!found) std::cout << "  CHANGED, recorded: " << *recorded << '\n';
  return !found;
}

int repro(const std::string& name, const std::vector<std::string>& globs) {
  const Bench bench = make_bench(globs);
  const std::vector<Entry> entries = cases_of(name);
  if (entries.empty()) throw std::runtime_error(name + ": expected at least one case, found none");
  bool changed = false;
  for (const Entry& entry : entries) {
    const Truth t = truth(entry.pair);
    const std::vector<Verdict> verdicts = decide(bench, entry.pair);
    const std::string* stratum = field(entry, "stratum");
    fmt::print("{}\n",
               stratum ? fmt::format("{}:{}:{}", *stratum, *field(entry, "seed"), *field(entry, "index")) : name);
    std::fflush(stdout);
    print_pair(std::cout, entry.pair, t, bench.lanes, verdicts);
    if (t.verdict != Verdict::declined) changed = compare_signatures(entry, t, bench.lanes, verdicts) || changed;
    std::cout.flush();
  }
  return changed ? 1 : 0;
}

}  // namespace

void add_repro(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "repro", "Run a stored case again, or the pair named STRATUM:SEED:INDEX; exit 1 when a verdict changed");
  command->footer("Example: graze repro near_edge_edge:1:42");
  auto name = std::make_shared<std::string>();
  auto lanes = std::make_shared<std::vector<std::string>>();
  command->add_option("case", *name, "A file of a campaign's cases/, or STRATUM:SEED:INDEX")->required();
  command->add_option("--lanes", *lanes, "Only lanes that match a pattern: GLOB,…")->delimiter(',');
  command->callback([name, lanes, &status] { status = repro(*name, *lanes); });
}

}  // namespace graze
