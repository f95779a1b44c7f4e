// SPDX-License-Identifier: Apache-2.0
// Adds the options --lanes, --subject and --executor, which are the same for all verbs; selects lanes, opens a user's
// code, and reports lanes that do not run.
#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "cli/commands.h"
#include "core/error.h"
#include "core/text.h"
#include "fuzz/campaign/checked_summary.h"
#include "subjects/published.h"
#include "subjects/subjects.h"

namespace graze::cli {

std::vector<std::string> compiler_flags(const std::vector<std::string>& texts) {
  std::vector<std::string> flags;
  for (const std::string& text : texts) {
    std::istringstream words(text);
    for (std::string word; words >> word;) flags.push_back(word);
  }
  return flags;
}

void add_subject_options(CLI::App& command, LaneOptions& options) {
  CLI::Option* subject =
      add_valued(
          command, "--subject", options.subjects, "NAME=WHAT",
          "Your own code; the names of its lanes begin with NAME/. WHAT is cmd:COMMAND, or FILE[:FUNCTION] for a "
          "shared object or a C, C++ or CUDA source; see docs/your_own_code.md. May be repeated")
          ->allow_extra_args(false);
  add_valued(command, "--flags", options.flags, "TEXT",
             "Compiler flags for subjects given as source files, such as --flags='-O3 -Iinclude'")
      ->needs(subject)
      ->allow_extra_args(false);
  add_valued(
      command, "--toolchains", options.toolchains, "NAME,...",
      "Toolchains that build additional lanes of the published algorithms and of subjects given as source files: "
      "names such as arm64-gcc, all, or FILE.toml; see docs/toolchains.md");
  add_valued(command, "--subject-timeout", options.timeout, "SECONDS", "Time limit per pair for a subject, in seconds")
      ->needs(subject)
      ->check(number(0.001, 86400.0))
      ->capture_default_str();
}

void add_lane_options(CLI::App& command, LaneOptions& options, Executors executors) {
  add_globs(command, "--lanes", options.globs, "Patterns of the lanes to run; !PATTERN leaves lanes out");
  add_subject_options(command, options);
  if (executors == Executors::twins) {
    options.executor = fuzz::Executor::twin;
    return;
  }
  static_assert(static_cast<int>(fuzz::Executor::automatic) == 0 && static_cast<int>(fuzz::Executor::device) == 1 &&
                static_cast<int>(fuzz::Executor::twin) == 2 && static_cast<int>(fuzz::Executor::both) == 3);
  add_valued(command, "--executor", options.executor, "auto|device|twin|both",
             "Executor of the CUDA lanes. auto: the device if there is one, else the twins; both: device and "
             "twins, compared")
      ->transform(one_of({"auto", "device", "twin", "both"}, Chosen::place))
      ->default_str("auto");
}

fuzz::Json recorded_spec_of(const std::filesystem::path& name) {
  for (const std::filesystem::path& directory : {name, name.parent_path().parent_path()}) {
    if (!std::filesystem::is_regular_file(directory / "summary.json")) continue;
    if (const fuzz::Json spec = fuzz::recorded_spec(directory); spec.is_object()) return spec;
  }
  return fuzz::Json::object();
}

void add_resubject_option(CLI::App& command, LaneOptions& options) {
  command.add_flag("--resubject", options.resubject, "Run your own code even if it has changed since the campaign ran");
}

void open_subjects(const LaneOptions& options) {
  if (options.subjects.empty() && options.toolchains.empty()) return;
  const std::vector<subjects::Toolchain> toolchains = options.toolchains.empty()
                                                          ? std::vector<subjects::Toolchain>()
                                                          : subjects::selected_toolchains(options.toolchains);
  // The toolchains for which --lanes selects a lane of the subject.
  const auto selected = [&](const std::string& name) {
    std::vector<subjects::Toolchain> result;
    for (const subjects::Toolchain& toolchain : toolchains) {
      if (matches_any(options.globs, name + "/f32/" + toolchain.name) ||
          matches_any(options.globs, name + "/f64/" + toolchain.name))
        result.push_back(toolchain);
    }
    return result;
  };
  std::string why_not;
  const bool on_device = options.executor != fuzz::Executor::twin && cuda::open_device(why_not);
  bool compiled = false;
  for (const std::string& text : options.subjects) {
    expect_utf8("--subject", text);
    subjects::Wanted wanted = subjects::parse_subject(text);
    wanted.flags = compiler_flags(options.flags);
    wanted.timeout = options.timeout;
    wanted.toolchains = selected(wanted.name);
    subjects::open(wanted, on_device);
    const std::string& kind = subjects::opened(wanted.name)->kind;
    compiled |= kind == "source" || kind == "cuda";
  }
  if (!options.flags.empty() && !compiled)
    throw UsageError("--flags: Graze compiles none of these subjects, so flags would have no effect");
  for (const Lane* lane : subjects::published_algorithms()) {
    const std::string id(lane->info->id);
    subjects::Wanted wanted{id, "published", {}, options.timeout};
    wanted.toolchains = selected(id);
    if (!wanted.toolchains.empty()) subjects::open(wanted);
  }
}

void open_subjects_of(const std::filesystem::path& name, bool resubject) {
  const subjects::Changed changed = resubject ? subjects::Changed::used : subjects::Changed::refused;
  for (const std::string& line : subjects::open_recorded(recorded_spec_of(name), false, changed))
    fmt::print(stderr, "graze: {}\n", printable(line));
}

std::vector<std::pair<std::string, std::string>> open_unchanged_subjects(const fuzz::Json& spec, bool resubject) {
  const subjects::Changed changed = resubject ? subjects::Changed::used : subjects::Changed::refused;
  std::vector<std::pair<std::string, std::string>> left_out;
  for (const fuzz::Json& row : spec.value("subjects", fuzz::Json::array())) {
    try {
      for (const std::string& line : subjects::open_recorded({{"subjects", fuzz::Json::array({row})}}, false, changed))
        fmt::print(stderr, "graze: {}\n", printable(line));
    } catch (const UsageError&) {
      throw;
    } catch (const std::runtime_error& error) {
      left_out.emplace_back(row.at("name"), printable(error.what()));
    }
  }
  return left_out;
}

std::vector<std::string> subject_names(const LaneOptions& options) {
  std::vector<std::string> names;
  for (const std::string& text : options.subjects) names.push_back(subjects::parse_subject(text).name);
  return names;
}

std::vector<std::string> with_subjects(std::vector<std::string> globs, const LaneOptions& options) {
  for (const std::string& name : subject_names(options)) globs.push_back(name + "/*");
  return globs;
}

void expect_own_code_among(const LaneOptions& options, const std::vector<std::string>& ids, const char* where) {
  for (const std::string& name : subject_names(options)) {
    if (std::none_of(ids.begin(), ids.end(), [&](const std::string& id) { return id.starts_with(name + '/'); }))
      throw UsageError(fmt::format("--subject {0}: {1} selects none of its lanes; add '{0}/*' to {1}", name, where));
  }
  if (options.toolchains.empty()) return;
  const std::vector<subjects::Toolchain> toolchains = subjects::selected_toolchains(options.toolchains);
  for (const std::string& word : CLI::detail::split(options.toolchains, ',')) {
    const std::string file = std::filesystem::absolute(word).lexically_normal().string();
    std::string name;
    const bool has_lane = std::any_of(toolchains.begin(), toolchains.end(), [&](const subjects::Toolchain& toolchain) {
      if (word != "all" && toolchain.file != file && !matches_any({word}, toolchain.name)) return false;
      name = toolchain.name;
      return std::any_of(ids.begin(), ids.end(), [&](const std::string& id) { return id.ends_with('/' + name); });
    });
    if (!has_lane && !name.empty())  // a later file may replace every toolchain of this one
      throw UsageError(fmt::format("--toolchains {0}: {1} selects none of its lanes; add '*/{2}' to {1}",
                                   printable(word), where, name));
  }
}

fuzz::SelectedLanes selected_lanes(const LaneOptions& options, const std::filesystem::path& about,
                                   bool require_device) {
  open_subjects(options);
  std::vector<fuzz::LaneLeftOut> not_opened;
  if (!about.empty()) {
    const fuzz::Json spec = recorded_spec_of(about);
    const std::string hint = options.resubject ? "" : "; --resubject runs the changed code";
    for (const auto& [subject, why] : open_unchanged_subjects(spec, options.resubject)) {
      for (const std::string id : spec.at("lanes")) {
        if (id.starts_with(subject + '/')) not_opened.push_back({id, why + hint});
      }
    }
  }
  fuzz::SelectedLanes under_test = fuzz::select_lanes(options.globs, options.executor, require_device, not_opened);
  fuzz::expect_each_runs(under_test);
  std::vector<std::string> ids;
  for (const Lane* lane : under_test.lanes) ids.push_back(lane->id);
  for (const fuzz::LaneLeftOut& row : under_test.left_out) ids.push_back(row.id);
  expect_own_code_among(options, ids, "--lanes");
  say_left_out(under_test.left_out);
  return under_test;
}

const Lane& named_lane(const std::string& id) {
  const Lane* lane = find_lane(id);
  return lane && lane->foreign ? *lane : published_lane(id);
}

std::string subject_words(const std::string& subject) {
  const subjects::Opened* opened = subjects::opened(subject);
  if (!opened) return "";
  if (opened->kind == "published") return "";
  std::string words = " --subject " + shell_word(opened->wanted.name + '=' + opened->wanted.what);
  for (const std::string& flag : opened->wanted.flags) words += ' ' + shell_word("--flags=" + flag);
  return words;
}

std::string own_words(const LaneOptions& options) {
  std::string words;
  for (const std::string& name : subject_names(options)) words += subject_words(name);
  return words + toolchain_words(options, {});
}

std::string toolchain_words(const LaneOptions& options, std::initializer_list<const Lane*> lanes) {
  std::string names = options.toolchains;
  for (const Lane* lane : lanes) {
    if (options.toolchains.empty() && !lane->toolchain.empty()) names += (names.empty() ? "" : ",") + lane->toolchain;
  }
  return names.empty() ? "" : " --toolchains " + shell_word(names);
}

void say_left_out(const std::vector<fuzz::LaneLeftOut>& left_out) {
  for (const std::string& line : fuzz::left_out_in_words(left_out)) fmt::print(stderr, "graze: {}\n", line);
}

void take_doubles_of(const std::vector<corpus::Entry>& entries, fuzz::SelectedLanes& under_test) {
  if (std::any_of(entries.begin(), entries.end(), [](const corpus::Entry& entry) { return bool(entry.doubles); }))
    take_doubles(under_test);
}

void take_doubles(fuzz::SelectedLanes& under_test) { say_left_out(fuzz::select_for_doubles(under_test)); }

}  // namespace graze::cli
