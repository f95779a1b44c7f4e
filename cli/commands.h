// SPDX-License-Identifier: Apache-2.0
// The verbs of `graze`. Each function adds a subcommand; its callback runs the verb and sets the exit status.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/verdict.h"
#include "core/whole.h"
#include "corpus/pair_format.h"
#include "fuzz/campaign/campaign_scene.h"
#include "fuzz/campaign/shard.h"
#include "fuzz/campaign/store_file.h"
#include "fuzz/selected_lanes.h"

namespace graze::cli {

#define GRAZE_TASK(name)
#define GRAZE_VERB(name, build) void add_##name(CLI::App& app, int& status);
#include "cli/verbs.inc"
#undef GRAZE_VERB
#undef GRAZE_TASK

// The values of --lanes, --subject and --executor in verbs that run lanes. Verbs that run twins instead of devices have
// no --executor.
struct LaneOptions {
  std::vector<std::string> globs;
  std::vector<std::string> subjects;  // NAME=WHAT
  std::vector<std::string> flags;     // for the compiler
  std::string toolchains;             // value of --toolchains; see subjects::selected_toolchains
  double timeout = 1;
  bool resubject = false;  // run a campaign's subjects even if their code has changed
  fuzz::Executor executor = fuzz::Executor::automatic;
};
enum class Executors { chosen, twins };
void add_lane_options(CLI::App& command, LaneOptions& options, Executors executors = Executors::chosen);

// Adds only the options for subjects.
void add_subject_options(CLI::App& command, LaneOptions& options);

// Splits the values of --flags into words.
std::vector<std::string> compiler_flags(const std::vector<std::string>& texts);

// Adds --resubject to a verb that reads campaigns and runs their subjects again.
void add_resubject_option(CLI::App& command, LaneOptions& options);

// Opens the subjects.   Throws: what subjects::open throws.
void open_subjects(const LaneOptions& options);

std::vector<std::string> subject_names(const LaneOptions& options);
// Adds the pattern "NAME/*" for each subject, for verbs whose default is not every lane.
std::vector<std::string> with_subjects(std::vector<std::string> globs, const LaneOptions& options);

// Returns the words " --subject NAME=WHAT --flags=…" that a command needs to run this subject; empty unless it is open.
std::string subject_words(const std::string& subject);

// Returns the subject_words of all subjects in the options.
std::string own_words(const LaneOptions& options);
// Returns the words " --toolchains arm64-gcc" for the toolchains of the options, or else of the lanes; empty for none.
std::string toolchain_words(const LaneOptions& options, std::initializer_list<const Lane*> lanes);

// Throws: UsageError if no lane of a subject or of --toolchains is among these names, so that no verb ignores such an
// option silently. where: the option or argument that names lanes.
void expect_own_code_among(const LaneOptions& options, const std::vector<std::string>& ids, const char* where);

// Returns the spec that a campaign recorded. `name` is the campaign's directory or one of its case files; other names
// give an empty object.
fuzz::Json recorded_spec_of(const std::filesystem::path& name);

// Opens the subjects of the recorded spec; with `resubject`, even if their code has changed.
// Throws: what subjects::open_recorded throws.
void open_subjects_of(const std::filesystem::path& name, bool resubject = false);

// Opens a spec's subjects. Skips code that has changed or is missing, so that the verb can continue without it.
// Returns: the names of the subjects that are left out, each with the reason.
std::vector<std::pair<std::string, std::string>> open_unchanged_subjects(const fuzz::Json& spec,
                                                                         bool resubject = false);

// Opens the subjects, including those recorded for the campaign or case file `about`, then selects the lanes. Reports
// on standard error which requested lanes do not run here, and why; one reason is that recorded code has changed.
// Throws: what subjects::open, fuzz::select_lanes and fuzz::expect_each_runs throw.
fuzz::SelectedLanes selected_lanes(const LaneOptions& options, const std::filesystem::path& about = {},
                                   bool require_device = false);

// Throws: UsageError unless this names a published lane without a policy.
const Lane& published_lane(const std::string& id);
// Like published_lane, but also accepts a lane of an open subject.
const Lane& named_lane(const std::string& id);

// The pairs of a campaign: strata are drawn again, and meshes are read again.
struct CampaignPairs {
  fuzz::Json summary;  // from checked_summary
  std::uint64_t seed = 1;
  std::vector<strata::PairSource> sources;
  std::string scene;  // the name of the pairs' scene; may be empty
};

// Returns the first pairs of each source of the campaign, `most` in all, or all pairs if `most` is 0. For an unfinished
// campaign, this includes pairs that are not judged yet.
// Throws: std::runtime_error for a hunt (the message names the verb); what checked_summary throws.
CampaignPairs pairs_of_campaign(const std::string& directory, std::uint64_t most, const char* verb);

// Lists these lanes on standard error, each with the reason.
void say_left_out(const std::vector<fuzz::LaneLeftOut>& left_out);

// Keeps the lanes that decide pairs of doubles, and names the others on standard error.
// Throws: what fuzz::select_for_doubles throws.
void take_doubles(fuzz::SelectedLanes& under_test);
// Calls take_doubles if some entry is a pair of doubles.
void take_doubles_of(const std::vector<corpus::Entry>& entries, fuzz::SelectedLanes& under_test);

// Adds an option whose argument is a comma-separated list of patterns.
CLI::Option* add_globs(CLI::App& command, const char* name, std::vector<std::string>& globs, const char* description);

// Writes the campaign's report as `graze report DIR` does, but prints nothing.   Throws: what that verb throws.
void write_report(const std::string& directory);

// Unpacks the file into the new folder NAME-unpacked, runs its campaign there, and compares the results with the
// pack's. Returns: the exit status, 1 if something differs.
int repro_pack(const std::string& file);

// `graze toolchain hip`: lists the products that hipcc (for AMD's GPUs) and nvcc (for NVIDIA's) fuse in the subjects,
// or in the published algorithms if there are no subjects. json: a file for the list; empty for none.   Returns: the
// exit status, 1 if products stay fused with -ffp-contract=off.
int list_hip_plans(const std::vector<std::string>& subjects, const std::vector<std::string>& flags,
                   const std::string& json);

// The pairs that a verb draws.
struct DrawOptions {
  std::uint64_t pairs = 1'000'000, seed = 1;
  std::vector<std::string> strata = {};  // patterns
  PairTypes coordinates = PairTypes::f32;
  std::string scene = {};  // the file; empty for none
};

// Adds --coordinates to a verb that draws pairs of either type, or of both at once.
enum class OfBothTypes { no, yes };
void add_coordinates_option(CLI::App& command, PairTypes& types, OfBothTypes both = OfBothTypes::yes);
// Adds --strata, --coordinates and --scene.
void add_draw_options(CLI::App& command, DrawOptions& options, OfBothTypes both = OfBothTypes::yes);

// If --coordinates is not given, uses the scene's type.   Throws: what strata::read_scene throws.
void take_type_of_scene(const CLI::App& command, DrawOptions& options);
PairTypes type_of_scene(const std::string& scene);

// Sets the command's callback, which calls take_type_of_scene and then runs the verb.
template <class Options, class Verb>
void run_drawing(CLI::App& command, const std::shared_ptr<Options>& options, int& status, Verb verb) {
  command.callback([&command, options, &status, verb] {
    take_type_of_scene(command, *options);
    status = verb(*options);
  });
}

// Measures the mesh in this coordinate type or, if none is given, in the type that the mesh needs. Writes the scene to
// the file, as `graze scene MESH --out FILE` does.   Throws: what that verb throws.
void write_scene_of(const std::string& mesh, const std::string& out, std::optional<PairTypes> type);

// Prints the sentences of `graze scene --sufficient RATE`: the cheapest published host lane that is wrong on at most
// this share of the scene's pairs, the cost of `exact`, and the strata that the scene leaves out.   Throws: what
// drawn() throws.
void print_sufficient(const std::string& scene, double rate);

// Draws from the scene, or from the strata if there is none. For a scene, sets `recorded` to the value of "scene" in
// the verb's results.   Throws: what strata::read_scene, strata::scene_sources and strata::stratum_sources throw.
strata::SceneSources drawn(const DrawOptions& options, fuzz::Json* recorded = nullptr);

// Lists the strata that the scene cannot contain, with the reasons, below a heading; empty for none.
std::string left_out_text(const std::vector<strata::LeftOut>& left_out);

// Accepts only whole numbers in [least, most], including forms such as 1e6, 10M or 1_000_000. For CLI11's transform().
CLI::Validator whole_number(std::uint64_t least, std::uint64_t most);

// Adds an option whose help shows `placeholder` for its value.
template <class Value>
CLI::Option* add_valued(CLI::App& command, const char* name, Value& value, const char* placeholder,
                        const std::string& description) {
  return command.add_option(name, value, description)->option_text(placeholder);
}

// Adds an option for a whole number in [least, most]; its help shows the default.
template <class Whole>
CLI::Option* add_count(CLI::App& command, const char* name, Whole& count, std::uint64_t least, std::uint64_t most,
                       const char* description) {
  return add_valued(command, name, count, "N", description)
      ->transform(whole_number(least, most))
      ->capture_default_str();
}

// Adds --shard K/N.
void add_shard_option(CLI::App& command, fuzz::Shard& shard, const char* description);

// Adds --threads to a verb that runs in parallel.
inline constexpr std::uint64_t kMostThreads = 4096;
CLI::Option* add_threads_option(CLI::App& command, int& threads);

// Accepts a number within these bounds; rejects NaN.
CLI::Validator number(double least, double most);

// Throws: UsageError for a file name that is not UTF-8, because results are UTF-8 and could not record it.
void expect_utf8(const std::string& what, const std::string& file);

// Accepts only these words. For CLI11's transform(), which keeps the word or replaces it with its index.
enum class Chosen { word, place };
CLI::Validator one_of(std::vector<std::string> words, Chosen chosen);

// Returns each lane's verdict on one pair. Reports on standard error if a device and its twin differ.
std::vector<Verdict> decide(const fuzz::SelectedLanes& under_test, const AnyPair& pair);

// Whether any verdict is wrong. No verdict is wrong if the truth is declined.
bool some_is_wrong(const std::vector<Verdict>& verdicts, Verdict truth);

// Returns, in one line, where the verdicts of the CUDA lanes under test come from; empty if there are no CUDA lanes.
std::string cuda_evidence(const fuzz::SelectedLanes& under_test);

}  // namespace graze::cli
