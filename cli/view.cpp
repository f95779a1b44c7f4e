// SPDX-License-Identifier: Apache-2.0
// `graze view`: writes a page that computes every verdict again while a triangle is dragged.
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>

#include "analysis/convention.h"
#include "cli/cases.h"
#include "cli/commands.h"
#include "cli/query_input.h"
#include "cli/results.h"
#include "core/error.h"
#include "core/text.h"
#include "fuzz/campaign/result_files.h"
#include "reports/viewer.h"
#include "strata/mesh.h"

extern char** environ;

namespace graze::cli {
namespace {

namespace fs = std::filesystem;
using reports::Viewed;

constexpr std::size_t kMostCandidates = 100'000;  // pairs of a mesh that are searched for wrong verdicts
constexpr std::size_t kMostOfAMesh = 500;         // pairs of a mesh that are shown

// Returns the user's own lanes, from --subject and from the shown campaign.   Throws: what selected_lanes throws.
fuzz::SelectedLanes lanes_of_own_code(LaneOptions options, const std::string& what) {
  options.executor = fuzz::Executor::twin;
  fuzz::SelectedLanes own = selected_lanes(options, what);
  own.keep_if([](const Lane& lane) { return lane.foreign; });
  return own;
}

// Returns the campaign's stored verdicts for lanes that cannot run now.
std::vector<reports::SaidOfPair> stored(const fuzz::SelectedLanes& own, const corpus::Entry& entry) {
  std::vector<reports::SaidOfPair> said;
  if (own.left_out.empty()) return said;
  const Verdict truth = truth_of(entry).verdict;
  for (const auto& [lane, verdict] : stored_verdicts_of(entry, own.left_out, truth))
    said.push_back({lane, verdict, is_wrong(verdict, truth), true});
  return said;
}

void add_verdicts(fuzz::SelectedLanes& own, Viewed& viewed) {
  const auto in_doubles = [](const reports::ViewedPair& one) { return !one.pair.floats; };
  if (!own.lanes.empty() && std::any_of(viewed.pairs.begin(), viewed.pairs.end(), in_doubles)) take_doubles(own);
  viewed.lanes_left_out = fuzz::left_out_json(own);
  if (own.lanes.empty()) return;
  for (reports::ViewedPair& one : viewed.pairs) {
    const oracle::Truth truth = oracle::truth(one.pair);
    const std::vector<Verdict> verdicts = decide(own, one.pair);
    const std::vector<Verdict> counted = analysis::excused(own.lanes, verdicts, one.pair, truth);
    for (std::size_t l = 0; l < verdicts.size(); ++l) {
      const bool wrong = truth.verdict != Verdict::declined && is_wrong(counted[l], truth.verdict);
      one.said.push_back({own.lanes[l]->id, verdicts[l], wrong});
    }
  }
}

void add_cases(const std::string& name, bool exact_input, const fuzz::SelectedLanes& own, Viewed& viewed,
               std::size_t most = reports::kMostViewedPairs) {
  for (const corpus::Entry& entry : read_cases(name, exact_input)) {
    if (most-- == 0 || viewed.pairs.size() == reports::kMostViewedPairs) break;
    viewed.pairs.push_back(
        {shown_name(fs::path(name).filename().string(), entry), corpus::pair_of(entry), stored(own, entry)});
  }
}

// Adds the simplest case of each signature of a campaign, or all cases of another folder.
void add_folder(const fs::path& folder, bool exact_input, const fuzz::SelectedLanes& own, Viewed& viewed) {
  const bool campaign = fs::is_directory(folder / "cases");
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(campaign ? folder / "cases" : folder)) {
    if (entry.path().extension() == ".pairs") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  if (files.empty()) throw std::runtime_error("there is no *.pairs in " + folder.string() + ", nor in its cases/");
  for (const fs::path& file : files)
    add_cases(file.string(), exact_input, own, viewed, campaign ? 1 : reports::kMostViewedPairs);
}

// Returns the exact verdict on a pair; declined unless the pair is finite.
Verdict exact_verdict(const AnyPair& pair) {
  const Lane* lane = find_lane(pair.floats ? "exact/f32/cpu" : "exact/f64/cpu");
  return visit(pair, [&](const auto& own) { return decide_one(lane->decide, own); });
}

// Adds the triangles, and the pairs whose boxes overlap, starting with those on which some lane is wrong. If some
// coordinates have more digits than float32 holds, all pairs are pairs of doubles.
void add_mesh(const fs::path& file, bool exact_input, Viewed& viewed) {
  expect_utf8("the mesh", file.string());
  const strata::MeshPairs mesh = strata::read_bodies({file});
  const bool in_doubles = mesh.rounding.beyond > 0;
  say_notes(in_doubles && !exact_input ? mesh.notes_of_doubles : mesh.notes, mesh.rounding, exact_input);
  const std::size_t shown = std::min(mesh.triangles.size(), reports::kMostViewedTriangles);
  for (std::size_t i = 0; i < shown; ++i)
    viewed.triangles.push_back(in_doubles ? mesh.in_doubles[i] : strata::in_doubles(mesh.triangles[i]));
  fuzz::SelectedLanes under_test = fuzz::select_lanes({}, fuzz::Executor::twin);
  if (in_doubles) fuzz::select_for_doubles(under_test);
  std::vector<reports::ViewedPair> others;
  for (std::size_t i = 0; i < std::min(mesh.size(), kMostCandidates) && viewed.pairs.size() < kMostOfAMesh; ++i) {
    const auto [first, second] = mesh.candidates[i];
    reports::ViewedPair one{fmt::format("{}, triangles {} and {}", file.filename().string(), first, second),
                            in_doubles ? AnyPair(mesh.double_pair(i)) : mesh.pair(i)};
    if (some_is_wrong(decide(under_test, one.pair), exact_verdict(one.pair))) {
      viewed.pairs.push_back(std::move(one));
    } else if (others.size() < kMostOfAMesh) {
      others.push_back(std::move(one));
    }
  }
  const std::size_t room = kMostOfAMesh - viewed.pairs.size();
  std::move(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(std::min(room, others.size())),
            std::back_inserter(viewed.pairs));
}

// If all pairs are hits of `graze query` with one reference, shows them all at once.
void show_against_the_first(Viewed& viewed) {
  const auto of_it = [&](const reports::ViewedPair& one) {
    return one.name.starts_with("reference_") && first_of(one.pair) == first_of(viewed.pairs[0].pair);
  };
  if (viewed.pairs.empty() || !std::all_of(viewed.pairs.begin(), viewed.pairs.end(), of_it)) return;
  for (const reports::ViewedPair& one : viewed.pairs) {
    viewed.triangles.push_back(second_of(one.pair));
    viewed.ids.push_back(std::strtoull(one.name.substr(one.name.rfind('_') + 1).c_str(), nullptr, 10));
  }
  viewed.opens_with_triangles = true;
}

// Adds the triangles of `graze query REFERENCE MESH`, hits first. Only the hits become pairs to show.
void add_query(const std::string& reference, const std::string& file, bool exact_input, Viewed& viewed) {
  const strata::MeshPairs of_references = read_references(reference), of_mesh = strata::read_triangles(file);
  const bool are_doubles = of_references.rounding.beyond > 0 || of_mesh.rounding.beyond > 0;
  say_notes(of_references, of_mesh, exact_input, are_doubles);
  if (of_references.triangles.size() != 1)
    throw std::runtime_error(fmt::format("graze view shows one reference, and {} has {}", printable(reference),
                                         of_references.triangles.size()));
  const auto references = of_references.triangles_in_doubles(), mesh = of_mesh.triangles_in_doubles();
  std::vector<TriangleOf<double>> others;
  std::vector<std::size_t> other_ids;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const AnyPair pair = are_doubles ? AnyPair(pair_of(references[0], mesh[i]))
                                     : pair_of(of_references.triangles[0], of_mesh.triangles[i]);
    const bool hit = exact_verdict(pair) == Verdict::intersects;
    const bool shown = hit || (viewed.pairs.empty() && i + 1 == mesh.size());  // one pair if there are no hits
    if (shown && viewed.pairs.size() < kMostOfAMesh)
      viewed.pairs.push_back({fmt::format("{}, triangle {}", printable(fs::path(file).filename().string()), i), pair});
    std::vector<TriangleOf<double>>& of = hit ? viewed.triangles : others;
    if (of.size() == reports::kMostViewedTriangles) continue;
    of.push_back(second_of(pair));
    (hit ? viewed.ids : other_ids).push_back(i);
  }
  const auto room =
      static_cast<std::ptrdiff_t>(std::min(reports::kMostViewedTriangles - viewed.triangles.size(), others.size()));
  viewed.triangles.insert(viewed.triangles.end(), others.begin(), others.begin() + room);
  viewed.ids.insert(viewed.ids.end(), other_ids.begin(), other_ids.begin() + room);
  viewed.title = fmt::format("hits of {} in {}", printable(reference), printable(fs::path(file).filename().string()));
  viewed.opens_with_triangles = true;
}

Viewed viewed_of(const std::string& what, const std::string& mesh, bool exact_input, const fuzz::SelectedLanes& own) {
  Viewed viewed;
  viewed.title = printable(fs::path(what).filename().string());
  std::error_code ignored;
  if (what.empty()) return viewed;
  if (!mesh.empty()) {
    add_query(what, mesh, exact_input, viewed);
  } else if (fs::is_directory(what, ignored)) {
    viewed.title = printable(what);
    add_folder(what, exact_input, own, viewed);
  } else if (strata::is_mesh(what)) {
    add_mesh(what, exact_input, viewed);
  } else {
    add_cases(what, exact_input, own, viewed);
    show_against_the_first(viewed);
  }
  return viewed;
}

// Opens the page in the desktop's default program, if there is a desktop; ignores failures.
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

void view(const LaneOptions& options, const std::string& what, const std::string& mesh, bool exact_input,
          std::size_t random, const std::string& out) {
  if (!reports::has_viewer()) {
    throw std::runtime_error(
        "the viewer is not in this build: it needs Node with npm, clang and wasi-libc; run scripts/setup to install "
        "them and build");
  }
  fuzz::SelectedLanes own = lanes_of_own_code(options, what);
  Viewed viewed = viewed_of(what, mesh, exact_input, own);
  if (!options.subjects.empty() && viewed.pairs.empty())
    throw UsageError("--subject: the page would store no pair, and so no verdict of your code; name pairs to show");
  add_verdicts(own, viewed);
  viewed.random = random;
  write_result(out, reports::viewer_page(viewed), fuzz::NamedBy::user);
  const std::size_t count = viewed.pairs.size();
  fmt::print("Wrote {}: {}{}\n", path_word(out),
             random > 0   ? fmt::format("{} random triangle{} of 2012", random, random == 1 ? "" : "s")
             : count == 0 ? "the special cases of 2012"
                          : fmt::format("{} pair{}", count, count == 1 ? "" : "s"),
             viewed.triangles.empty() ? "" : fmt::format(", {} triangles", viewed.triangles.size()));
  std::fflush(stdout);
  open_page(out);
}

}  // namespace

void add_view(CLI::App& app, int&) {
  CLI::App* command = app.add_subcommand(
      "view", "Write and open a web page that shows a pair in 3-D and decides it again on every lane while you drag");
  command->footer("Example: graze view thesis:1:0");
  auto what = std::make_shared<std::string>(), mesh = std::make_shared<std::string>(),
       out = std::make_shared<std::string>("view.html");
  auto random = std::make_shared<std::size_t>(0);
  CLI::Option* pairs =
      command->add_option("WHAT", *what,
                          "File of pairs, campaign directory or folder of such files, mesh (" + strata::mesh_formats() +
                              "), or STRATUM:SEED:INDEX (default: the special cases of the thesis of 2012)");
  command->add_option("MESH", *mesh,
                      "Mesh whose triangles are shown against WHAT, which is then a reference triangle as for `graze "
                      "query`: a file of "
                      "nine numbers, or MESH#FACE");
  add_valued(*command, "--random", *random, "N",
             "Number of random triangles to show first, drawn as in the thesis of 2012, against the thesis's reference")
      ->transform(whole_number(1, reports::kMostViewedTriangles))
      ->excludes(pairs);
  const auto exact_input = std::make_shared<bool>(false);
  add_exact_input(*command, *exact_input)->needs(pairs);
  const auto own_code = std::make_shared<LaneOptions>();
  add_subject_options(*command, *own_code);
  add_resubject_option(*command, *own_code);
  add_valued(*command, "--out", *out, "FILE", "File for the page")->capture_default_str();
  command->callback([=] { view(*own_code, *what, *mesh, *exact_input, *random, *out); });
}

}  // namespace graze::cli
