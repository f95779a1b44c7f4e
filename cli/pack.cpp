// SPDX-License-Identifier: Apache-2.0
// `graze pack`: writes a campaign, and everything needed to run it again, into one file; `graze repro FILE` runs it.
#include "fuzz/pack/pack.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "cli/changed.h"
#include "cli/commands.h"
#include "core/cannot.h"
#include "core/error.h"
#include "core/programs/run_program.h"
#include "core/text.h"
#include "fuzz/campaign/checked_summary.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/files.h"
#include "fuzz/own_files.h"
#include "reports/comparison.h"
#include "reports/report.h"
#include "reports/terminal.h"
#include "subjects/source_build.h"
#include "subjects/subjects.h"

namespace graze::cli {

using fuzz::Json;
namespace {

namespace fs = std::filesystem;

// Changes the working directory while the object lives.
class InFolder {
 public:
  explicit InFolder(const fs::path& folder) : before_(fs::current_path()) {
    fs::create_directories(folder);
    fs::current_path(folder);
  }
  ~InFolder() {
    std::error_code none;
    fs::current_path(before_, none);
  }
  InFolder(const InFolder&) = delete;
  InFolder& operator=(const InFolder&) = delete;

 private:
  fs::path before_;
};

// Opens the subjects using only the pack's files, so that Graze never writes a pack that lacks a file.
void expect_subjects_open(const fuzz::Pack& pack, const Json& recorded) {
  if (recorded.empty()) return;
  const Scratch scratch(subjects::cache_folder());
  fuzz::unpack(pack.files, scratch.path() / "pack");
  const InFolder folder(scratch.path() / "pack" / "files");
  for (std::size_t s = 0; s < recorded.size(); ++s) {
    const Json& row = pack.manifest["inputs"]["subjects"][s];
    const std::string name = row["name"];
    subjects::Wanted wanted = subjects::parse_subject(name + '=' + row["what"].get<std::string>());
    wanted.name += "@pack";  // no user can choose this name
    wanted.flags = row["flags"].get<std::vector<std::string>>();
    wanted.timeout = recorded[s].at("timeout");
    wanted.memory = recorded[s].at("memory");
    try {
      subjects::open(wanted);
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(
          cannot("pack", name, fmt::format("it does not open from the pack's own files: {}", printable(error.what()))));
    }
  }
}

void pack(const std::string& directory, std::string out) {
  const fs::path folder = fs::path(directory).lexically_normal();
  if (out.empty()) out = (folder.has_filename() ? folder : folder.parent_path()).string() + ".sqlar";
  if (const fs::path file = out; !fuzz::may_replace_foreign && fs::is_regular_file(file) && !fuzz::is_archive(file))
    throw UsageError(cannot("replace", file, fuzz::kForeign));
  open_subjects_of(directory);
  reports::make_report(directory);  // throws for a damaged record
  const fuzz::Pack pack = fuzz::pack_campaign(directory);
  expect_subjects_open(pack, recorded_spec_of(directory).value("subjects", Json::array()));
  fuzz::write_whole(out, fuzz::archive_of(pack.files), fuzz::NamedBy::user);
  fmt::print("Wrote {}: {}\n", printable(out), reports::counted(pack.files.size(), "file"));
  for (const Json& sentence : pack.manifest["not_packed"]) fmt::print("{}\n", sentence.get<std::string>());
  fmt::print("Next, on any machine with graze: graze repro {}\n", path_word(out));
}

// Runs the pack's command in this process.   Returns: its exit status.
int run(std::vector<std::string> words) {
  CLI::App app{"", "graze"};
  int status = 0;
  add_fuzz(app, status);
  add_hunt(app, status);
  words.erase(words.begin());  // "graze"
  std::reverse(words.begin(), words.end());
  app.parse(words);
  return status;
}

// Whether all counts, signatures and verdicts equal the pack's, as far as both campaigns record them.
bool is_reproduced(const fs::path& packed, const fs::path& again, const Json& rows) {
  const Json before = fuzz::checked_summary(packed), after = fuzz::checked_summary(again);
  for (const char* part : {"strata", "disagreements", "signatures"}) {
    if (before.at(part) != after.at(part)) return false;
  }
  if (fuzz::read_whole(packed / "hunt.json") != fuzz::read_whole(again / "hunt.json")) return false;
  return rows.is_null() || std::none_of(rows.begin(), rows.end(), [](const Json& row) {
           return row.at("known") == "changed" && row.at("most") > 0;
         });
}

}  // namespace

int repro_pack(const std::string& file) {
  const fuzz::Pack pack = fuzz::read_pack(file);
  const fs::path folder = fs::absolute(fs::path(file).stem().string() + "-unpacked"), packed = folder / "campaign",
                 again = folder / "again";
  fuzz::unpack(pack.files, folder);
  const Json summary = fuzz::checked_summary(packed);
  const Json spec = fuzz::spec_of_pack(summary.at("spec"), pack.manifest);
  fmt::print("Unpacked {} into {}; this command runs in its folder files/:\n  {}\n", shown_path(file),
             shown_path(folder.string()), fuzz::command_of(spec, {}, "../again", summary));
  for (const Json& sentence : pack.manifest["not_packed"]) fmt::print("{}\n", printable(sentence.get<std::string>()));
  std::fflush(stdout);
  {
    const InFolder inputs(folder / "files");
    if (const int status = run(fuzz::command_words(spec, {}, "../again", summary)); status != 0) return status;
  }
  const Json before = reports::make_report(packed);
  Json after = reports::make_report(again);
  const Json rows = reports::same_pairs(before, after) ? changed_rows(packed, again) : Json();
  reports::add_comparison(after, before, nullptr, nullptr, rows);
  const bool same = is_reproduced(packed, again, rows);
  fmt::print("\n{}\n", same ? "Reproduced: every count and every signature equals the pack's."
                            : "Not reproduced: some counts differ from the pack's.");
  print_comparison(after["compare"]);
  return same ? 0 : 1;
}

void add_pack(CLI::App& app, int&) {
  CLI::App* command = app.add_subcommand(
      "pack",
      "Write a campaign into one file with everything needed to run it again: results, spec, sources, meshes, "
      "versions");
  command->footer("Example: graze pack campaign\nOn another machine: graze repro campaign.sqlar");
  auto directory = std::make_shared<std::string>(), out = std::make_shared<std::string>();
  command->add_option("DIR", *directory, "Directory of a complete campaign")->required();
  add_valued(*command, "--out", *out, "FILE", "File for the pack (default: DIR.sqlar)");
  command->callback([directory, out] { pack(*directory, *out); });
}

}  // namespace graze::cli
