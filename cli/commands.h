// SPDX-License-Identifier: Apache-2.0
// The verbs of `graze`: each adds its subcommand, whose callback runs it and leaves the exit status.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "fuzz/campaign/campaign_scene.h"
#include "fuzz/campaign/store_file.h"
#include "fuzz/selected_lanes.h"

namespace graze::cli {

void add_fuzz(CLI::App& app, int& status);
void add_merge(CLI::App& app, int& status);
void add_status(CLI::App& app, int& status);
void add_plan(CLI::App& app, int& status);
void add_hunt(CLI::App& app, int& status);
void add_check(CLI::App& app, int& status);
void add_repro(CLI::App& app, int& status);
void add_minimize(CLI::App& app, int& status);
void add_corpus(CLI::App& app, int& status);
void add_explain(CLI::App& app, int& status);
void add_failures(CLI::App& app, int& status);
void add_league(CLI::App& app, int& status);
void add_map(CLI::App& app, int& status);
void add_dump(CLI::App& app, int& status);
void add_report(CLI::App& app, int& status);
void add_scene(CLI::App& app, int& status);
void add_lanes(CLI::App& app, int& status);
void add_invariants(CLI::App& app, int& status);
void add_strata(CLI::App& app, int& status);
void add_pareto(CLI::App& app, int& status);
void add_tune(CLI::App& app, int& status);
void add_prove_twin(CLI::App& app, int& status);
void add_view(CLI::App& app, int& status);
void add_query(CLI::App& app, int& status);
void add_bench(CLI::App& app, int& status);

// --lanes, --subject and --executor, which every verb that runs lanes has; the last not where twins stand for devices.
struct LaneOptions {
  std::vector<std::string> globs;
  std::vector<std::string> subjects;  // NAME=WHAT
  std::vector<std::string> flags;     // of the compiler
  double timeout = 1;
  fuzz::Executor executor = fuzz::Executor::automatic;
};
enum class Executors { chosen, twins };
void add_lane_options(CLI::App& command, LaneOptions& options, Executors executors = Executors::chosen);

// Opens the subjects.   Throws: as subjects::open.
void open_subjects(const LaneOptions& options);

// Opens the subjects that a campaign's directory recorded, or that of which this is a case file.   Throws: as
// subjects::open_recorded. Of anything else: nothing happens.
void open_subjects_of(const std::filesystem::path& name);

// Opens the subjects, those of what the command is about as well, then selects the lanes. Says on standard error which
// ones that were asked for do not run here, and why.
// Throws: as subjects::open, fuzz::select_lanes and fuzz::expect_each_runs.
fuzz::SelectedLanes selected_lanes(const LaneOptions& options, const std::filesystem::path& about = {},
                                   bool require_device = false);

// Names these lanes on standard error, each with the reason.
void say_left_out(const std::vector<fuzz::LaneLeftOut>& left_out);

// Patterns, separated by commas, in one argument.
CLI::Option* add_globs(CLI::App& command, const char* name, std::vector<std::string>& globs, const char* description);

// --scene, of every verb that draws from one.
void add_scene_option(CLI::App& command, std::string& file);

// What the verb draws then, and what its results record under "scene".
// Throws: as fuzz::open_scene and strata::scene_sources.
strata::SceneSources drawn_from_scene(const std::string& file, std::uint64_t seed, std::uint64_t pairs,
                                      const std::vector<std::string>& globs, fuzz::Json& recorded);

// The same of a scene, or without one (an empty name) of strata; recorded nowhere.
strata::SceneSources drawn(const std::string& scene, std::uint64_t seed, std::uint64_t pairs,
                           const std::vector<std::string>& globs);

// Which strata the scene cannot contain, and why: a line for each, below a heading; empty for none.
std::string left_out_text(const std::vector<strata::LeftOut>& left_out);

// The most of any number of pairs, and of seeds: 2^53, up to which all are whole in every reader of JSON.
inline constexpr std::uint64_t kMostWhole = std::uint64_t{1} << 53;

// Accepts whole numbers in [least, most], also as 1e6, 10M or 1_000_000, and nothing else. To be used by transform().
CLI::Validator whole_number(std::uint64_t least, std::uint64_t most);

// An option of a whole number in [least, most], whose default its help says.
template <class Whole>
CLI::Option* add_count(CLI::App& command, const char* name, Whole& count, std::uint64_t least, std::uint64_t most,
                       const char* description) {
  return command.add_option(name, count, description)
      ->transform(whole_number(least, most))
      ->capture_default_str()
      ->option_text("N");
}

// --threads, of every verb that runs several.
inline constexpr std::uint64_t kMostThreads = 4096;
CLI::Option* add_threads_option(CLI::App& command, int& threads);

// A number within these bounds, which no NaN is.
CLI::Validator number(double least, double most);

// Throws: UsageError for a file's name that results, which are UTF-8, could not record.
void expect_utf8(const std::string& what, const std::string& file);

// Accepts any text but an empty one, which names no file.
CLI::Validator not_empty();

// Accepts these words and nothing else. To be used by transform(), which leaves the word or its place.
enum class Chosen { word, place };
CLI::Validator one_of(std::vector<std::string> words, Chosen chosen);

// Each lane's verdict on one pair; reports on standard error where a device and its twin differ.
std::vector<Verdict> decide(const fuzz::SelectedLanes& under_test, const Pair& pair);

// Whether a verdict is not the truth; no verdict is wrong of a pair that the truth declines.
bool some_is_wrong(const std::vector<Verdict>& verdicts, Verdict truth);

// What runs the CUDA lanes under test, in one line: each kind of evidence once. Empty without CUDA lanes.
std::string cuda_evidence(const fuzz::SelectedLanes& under_test);

}  // namespace graze::cli
