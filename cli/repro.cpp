// SPDX-License-Identifier: Apache-2.0
// `graze repro`: runs a stored case, or a pair named STRATUM:SEED:INDEX, again on every lane and on the oracle.
#include <fmt/format.h>

#include <algorithm>
#include <iostream>

#include "analysis/convention.h"
#include "analysis/signature.h"
#include "cli/cases.h"
#include "cli/commands.h"
#include "cli/emit.h"
#include "cli/screen.h"
#include "core/error.h"
#include "core/text.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/pack/archive.h"
#include "oracle/truth.h"
#include "reports/terminal.h"

namespace graze::cli {
namespace {

enum class Compared { same, changed, nothing };

// Compares the recorded signature with the current one, for the recorded lanes that ran.
Compared compare(const analysis::Signature& recorded, const analysis::Signature& now,
                 std::span<const Lane* const> run) {
  const auto ran = [&](const std::string& lane) {
    return std::any_of(run.begin(), run.end(), [&](const Lane* l) { return l->lane_name().within_subject() == lane; });
  };
  bool compared = false;
  for (const analysis::WrongLane& wrong : recorded.wrong_lanes) {
    if (!ran(wrong.lane)) continue;
    if (now.mark_of(wrong.lane) != wrong.mark) return Compared::changed;
    compared = true;
  }
  analysis::Signature r = recorded, n = now;
  r.wrong_lanes.clear();
  n.wrong_lanes.clear();
  return r != n ? Compared::changed : compared ? Compared::same : Compared::nothing;
}

// Prints the pair's signatures, and whether the recorded one still applies.   Returns: whether it changed.
bool compare_signatures(const corpus::Entry& entry, const oracle::Truth& t, std::span<const Lane* const> run,
                        std::span<const Verdict> verdicts) {
  const std::string* text = corpus::field(entry, "signature");
  const std::optional<analysis::Signature> recorded = text ? analysis::parse_signature(*text) : std::nullopt;
  const Bucket bucket = corpus::visit(entry, [&](const auto& pair) { return oracle::margin_bucket(pair, t.verdict); });
  const Nesting nesting = corpus::visit(entry, [&](const auto& pair) { return analysis::nesting_of(pair, t); });
  const bool is_failure = recorded && !recorded->wrong_lanes.empty();
  Compared compared = is_failure ? Compared::nothing : Compared::changed;
  analysis::for_each_subject(run, [&](std::size_t first, std::size_t count) {
    const analysis::Signature now =
        analysis::signature(t, nesting, bucket, run.subspan(first, count), verdicts.subspan(first, count));
    const bool is_recorded = is_failure && recorded->subject == now.subject;
    if (is_recorded) compared = compare(*recorded, now, run.subspan(first, count));
    if (now.wrong()) {
      std::cout << "  signature: " << analysis::key(now)
                << (is_recorded && compared == Compared::same ? "  (as recorded)" : "") << '\n';
    }
  });
  if (!text) return false;
  if (compared == Compared::changed) std::cout << "  CHANGED, recorded: " << printable(*text) << '\n';
  if (compared == Compared::nothing)
    std::cout << "  not compared, because its lanes were not run: " << printable(*text) << '\n';
  return compared == Compared::changed;
}

// Prints the recorded parts of the truth that differ from the current truth.   Returns: whether there are any.
bool compare_truth(const corpus::Entry& entry, const oracle::Truth& t) {
  bool changed = false;
  for (const auto& [field, now] : fuzz::truth_fields(t)) {
    const std::string* recorded = corpus::field(entry, field);
    if (!recorded || *recorded == now) continue;
    std::cout << "  CHANGED, recorded: " << field << '=' << printable(*recorded) << '\n';
    changed = true;
  }
  return changed;
}

// If the lane's verdict differs from the recorded one (a field that `graze invariants` writes), prints the recorded
// verdict. Returns whether it differs.
bool compare_verdict(const corpus::Entry& entry, std::span<const Lane* const> run, std::span<const Verdict> verdicts) {
  const std::string lane = corpus::text_of(entry, "lanes"), recorded = corpus::text_of(entry, "says");
  const auto found = std::find_if(run.begin(), run.end(), [&](const Lane* each) { return each->id == lane; });
  if (recorded.empty() || found == run.end() || name(verdicts[found - run.begin()]) == recorded) return false;
  fmt::print("  CHANGED, recorded: {} {}\n", lane, printable(recorded));
  return true;
}

int repro(const std::string& name, const LaneOptions& lanes, const std::string& emitted) {
  if (fuzz::is_archive(name)) {
    if (!lanes.globs.empty() || !lanes.subjects.empty() || !lanes.toolchains.empty() || lanes.resubject ||
        lanes.executor != fuzz::Executor::automatic || !emitted.empty())
      throw UsageError(
          "graze repro: a pack runs as its campaign did; leave out --lanes, --subject, "
          "--toolchains, --executor, --resubject and --emit");
    return repro_pack(name);
  }
  fuzz::SelectedLanes under_test = selected_lanes(lanes, name);
  const std::vector<corpus::Entry> entries = read_cases(name);
  take_doubles_of(entries, under_test);
  if (!emitted.empty()) {
    const auto kind = std::find(std::begin(reports::kSnippetKinds), std::end(reports::kSnippetKinds), emitted);
    std::cout << emit(static_cast<reports::SnippetKind>(kind - std::begin(reports::kSnippetKinds)), name, entries,
                      under_test);
    return 0;
  }
  const std::string evidence = cuda_evidence(under_test);
  bool changed = false, wrong = false;
  for (const corpus::Entry& entry : entries) {
    const oracle::Truth t = truth_of(entry);
    const std::vector<Verdict> verdicts = decide(under_test, corpus::pair_of(entry));
    fmt::print("{}\n", printable(corpus::numbers_of(entry).value_or(name)));
    std::fflush(stdout);
    reports::print_pair(std::cout, corpus::pair_of(entry), t, under_test.lanes, verdicts, output_screen());
    if (!evidence.empty()) std::cout << reports::wrapped("CUDA lanes: " + evidence, output_screen().columns, 2, 4);
    if (const std::string stored = stored_verdicts(entry, under_test.left_out, t.verdict); !stored.empty())
      std::cout << reports::wrapped(stored, output_screen().columns, 2, 4);
    if (const std::string note = entry.doubles ? written_note(entry, t) : ""; !note.empty())
      std::cout << reports::wrapped(note, output_screen().columns, 2, 4);
    const std::vector<Verdict> counted = analysis::excused(under_test.lanes, verdicts, corpus::pair_of(entry), t);
    if (!fuzz::is_drawn(entry)) {
      std::cout << "  CHANGED, recorded: " << printable(corpus::numbers_of(entry).value_or("its stratum"))
                << ", which is another pair\n";
      changed = true;
    }
    changed = compare_truth(entry, t) || changed;
    changed = compare_verdict(entry, under_test.lanes, verdicts) || changed;
    if (t.verdict != Verdict::declined) changed = compare_signatures(entry, t, under_test.lanes, counted) || changed;
    wrong = wrong || some_is_wrong(counted, t.verdict);
    std::cout.flush();
  }
  if (wrong) fmt::print("Next: graze minimize {}{}\n", path_word(name), own_words(lanes));
  return changed ? 1 : 0;
}

}  // namespace

void add_repro(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "repro", "Run a stored case or a pack again, or print a case as a program; exit with 1 if a verdict has changed");
  command->footer("Example: graze repro near_edge_edge:1:42");
  auto name = std::make_shared<std::string>();
  auto lanes = std::make_shared<LaneOptions>();
  command
      ->add_option(
          "CASE", *name,
          "File of pairs, such as one of a campaign's cases/; STRATUM:SEED:INDEX; or a file of `graze pack`, whose "
          "code is built and run here: use packs only from people whose code you would run")
      ->required();
  add_lane_options(*command, *lanes);
  add_resubject_option(*command, *lanes);
  auto emitted = std::make_shared<std::string>();
  add_valued(
      *command, "--emit", *emitted, "cpp|cuda|python|obj|cgal|gtest",
      "Language of a program to print instead, for the first case on which a lane of --lanes is wrong; it "
      "includes or calls your own code. cpp and gtest show a CPU lane, cuda a CUDA lane, gtest also your own CUDA "
      "code, python and cgal the truth")
      ->transform(one_of(std::vector<std::string>(std::begin(reports::kSnippetKinds), std::end(reports::kSnippetKinds)),
                         Chosen::word));
  command->callback([name, lanes, emitted, &status] { status = repro(*name, *lanes, *emitted); });
}

}  // namespace graze::cli
