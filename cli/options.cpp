// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>
#include <sstream>

#include "cli/commands.h"
#include "cli/shard_option.h"
#include "core/error.h"
#include "core/text.h"
#include "fuzz/campaign/checked_summary.h"
#include "subjects/subjects.h"

namespace graze::cli {

namespace {

// Parses "1000000", "1_000_000", "1e6", "2.5e6" or "10M".   Returns: nothing if it is not a whole number, or too large.
std::optional<std::uint64_t> parse_count(std::string_view text) {
  std::string digits;
  int power = 0;
  bool fraction = false;
  while (!text.empty() && (std::isdigit(static_cast<unsigned char>(text[0])) || text[0] == '.' || text[0] == '_')) {
    const char c = text[0];
    text.remove_prefix(1);
    if (c == '_' && (digits.empty() || fraction || text.empty() || !std::isdigit(static_cast<unsigned char>(text[0]))))
      return std::nullopt;
    if (c == '.' && (fraction || digits.empty() || text.empty())) return std::nullopt;
    if (c == '.') fraction = true;
    if (c == '_' || c == '.') continue;
    digits += c;
    power -= fraction;
  }
  if (digits.empty()) return std::nullopt;
  if (text.size() == 1 && std::string_view("kMGT").find(text[0]) != text.npos) {
    power += 3 * (1 + static_cast<int>(std::string_view("kMGT").find(text[0])));
  } else if (text.starts_with('e') || text.starts_with('E')) {
    const std::optional<std::uint64_t> exponent = parse_whole(text.substr(1));
    if (!exponent || *exponent > 99) return std::nullopt;
    power += static_cast<int>(*exponent);
  } else if (!text.empty()) {
    return std::nullopt;
  }
  for (; power < 0 && digits.ends_with('0'); ++power) digits.pop_back();
  if (power < 0) return std::nullopt;
  return parse_whole(digits + std::string(static_cast<std::size_t>(power), '0'));
}

}  // namespace

CLI::Option* add_globs(CLI::App& command, const char* name, std::vector<std::string>& globs, const char* description) {
  const auto split = [name, &globs](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      for (std::size_t begin = 0, end; begin <= text.size(); begin = end + 1) {
        end = std::min(text.find(',', begin), text.size());
        if (begin == end)
          throw UsageError(fmt::format("{}: expected patterns with commas between, found '{}'", name, text));
        std::string part = text.substr(begin, end - begin);
        // A comma may also continue a lane's policy: "moller_1997/f32/cpu/plane_distance=abs:1e-6,separation=rel:8".
        if (const bool goes_on = part.find('=') < part.find('/') && !globs.empty(); goes_on) {
          globs.back() += ',' + part;
        } else {
          globs.push_back(std::move(part));
        }
      }
    }
  };
  return command.add_option_function<std::vector<std::string>>(name, split, description)
      ->allow_extra_args(false)
      ->option_text("GLOB,…")
      ->default_str("all");
}

void add_shard_option(CLI::App& command, fuzz::Shard& shard, const char* description) {
  const auto check = [](const std::string& text) {
    return fuzz::parse_shard(text)
               ? ""
               : fmt::format("expected K/N, 1 to N of at most {}, found '{}'", fuzz::kMostShards, printable(text));
  };
  command
      .add_option_function<std::string>(
          "--shard", [&shard](const std::string& text) { shard = *fuzz::parse_shard(text); }, description)
      ->check(CLI::Validator(check, ""))
      ->option_text("K/N");
}

CLI::Validator whole_number(std::uint64_t least, std::uint64_t most) {
  const auto check = [least, most](std::string& text) -> std::string {
    const std::optional<std::uint64_t> value = parse_count(text);
    if (!value || *value < least || *value > most)
      return fmt::format("expected a whole number from {} to {}, found '{}'", least, most, printable(text));
    text = std::to_string(*value);
    return {};
  };
  return CLI::Validator(check, "");
}

CLI::Option* add_threads_option(CLI::App& command, int& threads) {
  return add_count(command, "--threads", threads, 0, kMostThreads,
                   "Number of threads; 0 means one per core. Results do not depend on it");
}

CLI::Validator number(double least, double most) {
  const auto check = [least, most](std::string& text) -> std::string {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc() && end == text.data() + text.size() && value >= least && value <= most) return {};
    return fmt::format("expected a number from {} to {}, found '{}'", least, most, printable(text));
  };
  return CLI::Validator(check, "");
}

CLI::Validator one_of(std::vector<std::string> words, Chosen chosen) {
  const auto check = [words = std::move(words), chosen](std::string& text) -> std::string {
    const auto found = std::find(words.begin(), words.end(), text);
    if (found == words.end()) {
      return fmt::format("expected {} or {}, found '{}'", fmt::join(words.begin(), words.end() - 1, ", "), words.back(),
                         printable(text));
    }
    if (chosen == Chosen::place) text = std::to_string(found - words.begin());
    return {};
  };
  return CLI::Validator(check, "");
}

void expect_utf8(const std::string& what, const std::string& file) {
  const std::string text = fuzz::Json(file).dump(-1, ' ', false, fuzz::Json::error_handler_t::replace);
  if (fuzz::Json::parse(text) != file)
    throw UsageError(what + ": the file name " + text + " is not UTF-8, as the results must be; rename the file");
}

CLI::Validator not_empty() {
  return CLI::Validator([](std::string& text) { return text.empty() ? "expected a name, found ''" : std::string(); },
                        "");
}

void add_subject_options(CLI::App& command, LaneOptions& options) {
  CLI::Option* subject =
      command
          .add_option(
              "--subject", options.subjects,
              "Your own code, as lanes NAME/…. WHAT is a shared object or a C, C++ or CUDA source with :FUNCTION, or "
              "cmd:COMMAND; see docs/your_own_code.md. May be repeated")
          ->allow_extra_args(false)
          ->option_text("NAME=WHAT");
  command
      .add_option("--flags", options.flags,
                  "Compiler flags for subjects that are sources, such as --flags='-O3 -Iinclude'")
      ->needs(subject)
      ->allow_extra_args(false)
      ->option_text("TEXT");
  command.add_option("--subject-timeout", options.timeout, "Time limit of a subject for one pair, in seconds")
      ->needs(subject)
      ->check(number(0.001, 86400.0))
      ->capture_default_str()
      ->option_text("SECONDS");
}

void add_lane_options(CLI::App& command, LaneOptions& options, Executors executors) {
  add_globs(command, "--lanes", options.globs, "Patterns of the lanes to run");
  add_subject_options(command, options);
  if (executors == Executors::twins) {
    options.executor = fuzz::Executor::twin;
    return;
  }
  static_assert(static_cast<int>(fuzz::Executor::automatic) == 0 && static_cast<int>(fuzz::Executor::device) == 1 &&
                static_cast<int>(fuzz::Executor::twin) == 2 && static_cast<int>(fuzz::Executor::both) == 3);
  command
      .add_option("--executor", options.executor,
                  "Executor of the CUDA lanes. auto: the device if there is one, else its twin; both: device and twin, "
                  "compared")
      ->transform(one_of({"auto", "device", "twin", "both"}, Chosen::place))
      ->option_text("auto|device|twin|both")
      ->default_str("auto");
}

fuzz::Json recorded_spec_of(const std::filesystem::path& name) {
  for (const std::filesystem::path& directory : {name, name.parent_path().parent_path()}) {
    if (!std::filesystem::is_regular_file(directory / "summary.json")) continue;
    if (const fuzz::Json spec = fuzz::recorded_spec(directory); spec.is_object()) return spec;
  }
  return fuzz::Json::object();
}

void open_subjects_of(const std::filesystem::path& name) {
  for (const std::string& line : subjects::open_recorded(recorded_spec_of(name)))
    fmt::print(stderr, "graze: {}\n", printable(line));
}

void open_subjects(const LaneOptions& options) {
  if (options.subjects.empty()) return;
  std::string why_not;
  const bool on_device = options.executor != fuzz::Executor::twin && cuda::open_device(why_not);
  for (const std::string& text : options.subjects) {
    subjects::Wanted wanted = subjects::parse_subject(text);
    for (const std::string& flags : options.flags) {
      std::istringstream words(flags);
      for (std::string word; words >> word;) wanted.flags.push_back(word);
    }
    wanted.timeout = options.timeout;
    subjects::open(wanted, on_device);
  }
}

fuzz::SelectedLanes selected_lanes(const LaneOptions& options, const std::filesystem::path& about,
                                   bool require_device) {
  open_subjects(options);
  if (!about.empty()) open_subjects_of(about);
  fuzz::SelectedLanes under_test = fuzz::select_lanes(options.globs, options.executor, require_device);
  fuzz::expect_each_runs(under_test);
  for (const std::string& text : options.subjects) {
    const std::string subject = subjects::parse_subject(text).name + '/';
    const auto is_of = [&](const std::string& lane) { return lane.starts_with(subject); };
    if (std::none_of(under_test.lanes.begin(), under_test.lanes.end(), [&](auto* lane) { return is_of(lane->id); }) &&
        std::none_of(under_test.left_out.begin(), under_test.left_out.end(), [&](auto& row) { return is_of(row.id); }))
      throw UsageError(fmt::format("--subject {0}: --lanes has no lane of it; add '{0}/*' there",
                                   subject.substr(0, subject.size() - 1)));
  }
  say_left_out(under_test.left_out);
  return under_test;
}

const Lane& published_lane(const std::string& id) {
  const Lane* lane = find_lane(id);
  if (lane && lane->algorithm >= 0) return *lane;
  std::vector<std::string> ids;
  for (const Lane& row : published_lanes()) ids.push_back(row.id);
  throw UsageError("there is no published lane '" + printable(id) + "'; `graze lanes` lists them" +
                   did_you_mean(id, ids));
}

void say_left_out(const std::vector<fuzz::LaneLeftOut>& left_out) {
  for (const std::string& line : fuzz::left_out_in_words(left_out)) fmt::print(stderr, "graze: {}\n", line);
}

std::vector<Verdict> decide(const fuzz::SelectedLanes& under_test, const Pair& pair) {
  std::vector<const Lane*> apart;
  std::vector<Verdict> verdicts = decide(under_test, pair, apart);
  for (const Lane* lane : apart) fmt::print(stderr, "graze: {}: device and twin differ\n", lane->id);
  return verdicts;
}

bool some_is_wrong(const std::vector<Verdict>& verdicts, Verdict truth) {
  return truth != Verdict::declined &&
         std::any_of(verdicts.begin(), verdicts.end(), [&](Verdict verdict) { return is_wrong(verdict, truth); });
}

std::string cuda_evidence(const fuzz::SelectedLanes& under_test) {
  std::set<std::string> kinds;
  for (std::size_t l = 0; l < under_test.lanes.size(); ++l) {
    if (const std::string by = under_test.evidence(l); !by.empty()) kinds.insert(by);
  }
  return fmt::format("{}", fmt::join(kinds, "; "));
}

}  // namespace graze::cli
