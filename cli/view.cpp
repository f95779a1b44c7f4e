// SPDX-License-Identifier: Apache-2.0
// `graze view`: one page in which every verdict is decided anew while a triangle is dragged.
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>

#include "cli/cases.h"
#include "cli/commands.h"
#include "core/error.h"
#include "core/text.h"
#include "cuda/twin/twin.h"
#include "fuzz/campaign/result_files.h"
#include "reports/viewer.h"
#include "strata/mesh.h"

extern char** environ;

namespace graze::cli {
namespace {

namespace fs = std::filesystem;
using reports::Viewed;

constexpr std::size_t kMostCandidates = 100'000;  // pairs of a mesh that are searched for wrong verdicts
constexpr std::size_t kMostOfAMesh = 500;         // that are shown

std::string name_of(const std::string& file, const corpus::Entry& entry) {
  if (const std::optional<std::string> numbers = corpus::numbers_of(entry)) return printable(*numbers);
  const std::string* label = corpus::field(entry, "name");
  return printable(label ? *label : entry.line > 0 ? fmt::format("{}:{}", file, entry.line) : file);
}

void add_cases(const std::string& name, Viewed& viewed, std::size_t most = reports::kMostViewedPairs) {
  for (const corpus::Entry& entry : read_cases(name)) {
    if (most-- == 0 || viewed.pairs.size() == reports::kMostViewedPairs) break;
    viewed.pairs.push_back({name_of(fs::path(name).filename().string(), entry), entry.pair});
  }
}

// Of a campaign the simplest case of each signature, of another folder all cases.
void add_folder(const fs::path& folder, Viewed& viewed) {
  const bool campaign = fs::is_directory(folder / "cases");
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(campaign ? folder / "cases" : folder)) {
    if (entry.path().extension() == ".pairs") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  if (files.empty()) throw std::runtime_error(folder.string() + ": expected *.pairs in it, or in its cases/, found none");
  for (const fs::path& file : files) add_cases(file.string(), viewed, campaign ? 1 : reports::kMostViewedPairs);
}

bool is_mesh(const fs::path& file) {
  const std::string extension = file.extension().string();
  return extension == ".off" || extension == ".obj" || extension == ".stl" || extension == ".ply";
}

bool some_lane_is_wrong(const Pair& pair) {
  const Lane* exact = find_lane("exact/f32/cpu");
  const Verdict truth = decide_one(exact->decide, pair);
  return std::any_of(lanes().begin(), lanes().end(), [&](const Lane& lane) {
    const DecideBlock block = runs_on_this_cpu(lane) || lane.is_cuda() ? cuda::block_on_host(lane) : nullptr;
    return block && decide_one(block, pair) != truth;
  });
}

// The triangles, and of the pairs whose boxes overlap first those on which some lane is wrong.
void add_mesh(const fs::path& file, Viewed& viewed) {
  const strata::MeshPairs mesh = strata::read_mesh_pairs(file);
  const std::size_t shown = std::min(mesh.triangles.size(), reports::kMostViewedTriangles);
  viewed.triangles.assign(mesh.triangles.begin(), mesh.triangles.begin() + static_cast<std::ptrdiff_t>(shown));
  std::vector<reports::ViewedPair> others;
  for (std::size_t i = 0; i < std::min(mesh.size(), kMostCandidates) && viewed.pairs.size() < kMostOfAMesh; ++i) {
    const auto [first, second] = mesh.candidates[i];
    reports::ViewedPair one{fmt::format("{}, triangles {} and {}", file.filename().string(), first, second), mesh.pair(i)};
    if (some_lane_is_wrong(one.pair)) {
      viewed.pairs.push_back(std::move(one));
    } else if (others.size() < kMostOfAMesh) {
      others.push_back(std::move(one));
    }
  }
  const std::size_t room = kMostOfAMesh - viewed.pairs.size();
  std::move(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(std::min(room, others.size())), std::back_inserter(viewed.pairs));
}

Viewed viewed_of(const std::string& what) {
  Viewed viewed{printable(fs::path(what).filename().string()), {}, {}};
  std::error_code ignored;
  if (what.empty()) return viewed;
  if (fs::is_directory(what, ignored)) {
    viewed.title = printable(what);
    add_folder(what, viewed);
  } else if (is_mesh(what)) {
    add_mesh(what, viewed);
  } else {
    add_cases(what, viewed);
  }
  return viewed;
}

// By the desktop, where there is one; whether it does is its affair.
void open_page(const std::string& page) {
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY")) return;
  std::string file = page, opener = "xdg-open";
  char* words[] = {opener.data(), file.data(), nullptr};
  posix_spawn_file_actions_t quiet;
  posix_spawn_file_actions_init(&quiet);
  for (const int output : {1, 2}) posix_spawn_file_actions_addopen(&quiet, output, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  if (posix_spawnp(&child, words[0], &quiet, nullptr, words, environ) == 0) waitpid(child, nullptr, 0);
  posix_spawn_file_actions_destroy(&quiet);
}

void view(const std::string& what, const std::string& out) {
  if (!reports::has_viewer()) {
    throw std::runtime_error(
        "view: expected a build with the viewer, found one without: it takes Node with npm, clang and wasi-libc "
        "(scripts/packages.txt)");
  }
  const Viewed viewed = viewed_of(what);
  fuzz::write_whole(out, reports::viewer_page(viewed));
  const std::size_t count = viewed.pairs.size();
  fmt::print("Wrote {}: {}{}\n", shell_word(out),
             count == 0 ? "the special cases of 2012" : fmt::format("{} pair{}", count, count == 1 ? "" : "s"),
             viewed.triangles.empty() ? "" : fmt::format(", {} triangles", viewed.triangles.size()));
  std::fflush(stdout);
  open_page(out);
}

}  // namespace

void add_view(CLI::App& app, int&) {
  CLI::App* command = app.add_subcommand(
      "view", "Write one page that shows a pair in 3-D and decides every verdict anew while you drag, and open it");
  command->footer("Example: graze view thesis:1:0");
  auto what = std::make_shared<std::string>(), out = std::make_shared<std::string>("view.html");
  command->add_option("what", *what,
                      "A file of pairs, a campaign's or any folder of them, a mesh (OFF, OBJ, STL, PLY), or "
                      "STRATUM:SEED:INDEX; without it the special cases of 2012");
  command->add_option("--out", *out, "The page")->check(not_empty())->capture_default_str()->option_text("FILE");
  command->callback([what, out] { view(*what, *out); });
}

}  // namespace graze::cli
