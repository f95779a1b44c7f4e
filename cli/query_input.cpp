// SPDX-License-Identifier: Apache-2.0
#include "cli/query_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include <graze/query.h>

#include "backends/backends.h"
#include "cli/cases.h"
#include "core/cannot.h"
#include "core/error.h"
#include "core/plain_file.h"
#include "core/text.h"
#include "fuzz/files.h"
#include "strata/mesh.h"
#include "strata/mesh_readers/lines.h"

namespace graze::cli {
namespace {

strata::MeshPairs read_numbers(const std::string& file) {
  std::string why;
  std::optional<std::string> read = plain_file(file, why);
  if (!read) throw std::runtime_error(cannot("read", file, why));
  std::string text = std::move(*read);
  std::replace(text.begin(), text.end(), ',', ' ');
  strata::Lines lines({file, text}, '#');
  strata::MeshPairs references;
  std::vector<strata::Coordinate> numbers;
  while (lines.next()) {
    for (std::size_t i = 0; i < lines.words().size(); ++i) numbers.push_back(lines.coordinate(i, references.rounding));
  }
  if (numbers.empty() || numbers.size() % 9 != 0)
    throw std::runtime_error(
        fmt::format("{}: expected nine numbers for each reference, found {}", file, numbers.size()));
  references.triangles.resize(numbers.size() / 9);
  references.in_doubles.resize(numbers.size() / 9);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    (&references.triangles[i / 9][0].x)[i % 9] = numbers[i].stored;
    (&references.in_doubles[i / 9][0].x)[i % 9] = numbers[i].written;
  }
  references.notes = strata::rounding_note(file, references.rounding);
  references.notes_of_doubles = strata::doubles_note(file, references.rounding);
  return references;
}

}  // namespace

QueryLanes query_lanes(const LaneOptions& options, const std::vector<std::string>& common) {
  open_subjects(options);
  QueryLanes result;
  fuzz::SelectedLanes& under_test = result.under_test;
  const auto is_known = [&](const Lane& lane) {
    return std::find(result.ids.begin(), result.ids.end(), lane.id) != result.ids.end();
  };
  const auto leaves_out = [](const std::string& glob) { return glob.starts_with(fuzz::kLeaveOut); };
  const bool any_wanted = !std::all_of(options.globs.begin(), options.globs.end(), leaves_out);
  for (const std::string& glob : any_wanted ? options.globs : with_subjects(common, options)) {
    if (leaves_out(glob)) continue;
    if (glob == "exact") {
      if (matches_any(options.globs, glob)) result.ids.push_back(glob);
      continue;
    }
    fuzz::expect_each_matches({glob});
    if (any_wanted) under_test.asked.push_back(glob);
    for (const Lane& lane : lanes()) {
      if (!matches_any({glob}, lane.id) || !matches_any(options.globs, lane.id) || is_known(lane)) continue;
      const bool by_gpu = graze_devices() > 0 && backends::backend_of(lane).has_device;
      const std::string why_not = by_gpu ? "" : backends::why_not_on_host(lane);
      if (why_not.empty()) {
        result.ids.push_back(lane.id);
        under_test.lanes.push_back(&lane);
      } else if (any_wanted || lane.foreign) {
        under_test.left_out.push_back({lane.id, why_not});
      }
    }
  }
  if (result.ids.empty() && under_test.left_out.empty()) throw UsageError("the patterns of --lanes leave no lane");
  fuzz::expect_each_runs(under_test);
  expect_own_code_among(options, result.ids, "--lanes");
  say_left_out(under_test.left_out);
  return result;
}

strata::MeshPairs read_references(const std::string& name) {
  const std::size_t hash = name.rfind('#');
  if (strata::is_mesh(name) && std::filesystem::exists(name))
    throw UsageError(
        fmt::format("REFERENCE {0} is a mesh: name one of its faces, such as {0}#0; --self {0} finds the "
                    "pairs of its faces that intersect",
                    path_word(name)));
  if (hash == name.npos || std::filesystem::exists(name)) return read_numbers(name);
  const std::optional<std::uint64_t> face = parse_whole(name.substr(hash + 1));
  if (!face) throw UsageError(name + ": expected MESH#FACE with a whole number, found '" + name.substr(hash + 1) + "'");
  const std::string file = name.substr(0, hash);
  strata::MeshPairs mesh = strata::read_triangles(file);
  if (*face >= mesh.triangles.size())
    throw std::runtime_error(
        fmt::format("{} has no face {}: it has {}, numbered from 0", file, *face, mesh.triangles.size()));
  mesh.triangles = {mesh.triangles[*face]};
  if (!mesh.in_doubles.empty()) mesh.in_doubles = {mesh.in_doubles[*face]};
  return mesh;
}

void say_notes(const strata::MeshPairs& references, const strata::MeshPairs& mesh, bool exact_input, bool are_doubles) {
  const auto which = are_doubles && !exact_input ? &strata::MeshPairs::notes_of_doubles : &strata::MeshPairs::notes;
  std::vector<std::string> notes = references.*which;
  notes.insert(notes.end(), (mesh.*which).begin(), (mesh.*which).end());
  strata::Rounding rounding = references.rounding;
  say_notes(notes, rounding += mesh.rounding, exact_input);
}

std::string obj_of(const std::vector<ObjGroup>& groups) {
  const auto digits = [](double x) {
    return static_cast<double>(static_cast<float>(x)) == x ? fmt::format("{:.9g}", x) : fmt::format("{:.17g}", x);
  };
  std::string text = "# Written by graze query\n";
  std::size_t vertex = 1;
  for (const ObjGroup& group : groups) {
    text += "g " + group.name + "\n";
    for (const TriangleOf<double>& triangle : group.triangles) {
      for (const Vec3<double>& v : triangle) text += fmt::format("v {} {} {}\n", digits(v.x), digits(v.y), digits(v.z));
      text += fmt::format("f {} {} {}\n", vertex, vertex + 1, vertex + 2);
      vertex += 3;
    }
  }
  return text;
}

}  // namespace graze::cli
