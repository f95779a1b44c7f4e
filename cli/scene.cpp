// SPDX-License-Identifier: Apache-2.0
// `graze scene`: writes a scene file from meshes or pairs. Also adds the options for verbs that draw pairs.
#include <fmt/format.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <functional>
#include <iostream>

#include "analysis/measure_scene.h"
#include "cli/cases.h"
#include "cli/commands.h"
#include "cli/results.h"
#include "core/error.h"
#include "core/exact/exact.h"
#include "core/text.h"
#include "corpus/pair_format.h"
#include "fuzz/files.h"
#include "reports/terminal.h"
#include "strata/mesh.h"

namespace graze::cli {
namespace {

namespace fs = std::filesystem;

struct SceneVerb {
  std::vector<std::string> files;
  std::string out, poses, units = "units";
  std::optional<PairTypes> coordinates;  // if not given, the type that the input needs
  double sufficient = 0;                 // the rate; 0: not given
  bool exact_input = false;
};

std::string relative_to(const fs::path& folder, const std::string& file) {
  const fs::path path(file);
  return path.is_absolute() ? file : path.lexically_normal().lexically_proximate(folder.lexically_normal()).string();
}

// The measured input, in its own type.
struct Measured {
  strata::SceneFile scene;
  std::size_t triangles;
  std::uint64_t pairs;
};

template <class Real>
Measured measured(const analysis::BasicSceneSample<Real>& sample, const std::string& name) {
  return {analysis::measure_scene(sample, name), sample.triangles.size(), sample.pairs};
}

Measured measured_pairs(const std::string& file, const SceneVerb& options) {
  std::vector<Pair> pairs;
  std::vector<DoublePair> doubles;
  bool of_doubles = options.coordinates == PairTypes::f64;
  for (const corpus::Entry& entry : corpus::read_pairs(file, PairTypes::both)) {
    const bool finite = options.coordinates == PairTypes::f32
                            ? is_finite(entry.pair)
                            : corpus::visit(entry, [](const auto& pair) { return is_finite(pair); });
    if (!finite)
      throw std::runtime_error(fmt::format("cannot measure {}, line {}: a coordinate is not finite", file, entry.line));
    if (options.exact_input) expect_exact_input(file, entry);
    of_doubles |= entry.doubles && !options.coordinates;
    pairs.push_back(entry.pair);
    doubles.push_back(corpus::pair_of(entry).doubles);
  }
  return of_doubles ? measured(analysis::sample_of(doubles), file) : measured(analysis::sample_of(pairs), file);
}

template <class Real>
bool intersects(const BasicPair<Real>& pair) {
  return exact::intersects(&pair.a[0].x, &pair.b[0].x);
}

// Returns how many pairs change their verdict when they are stored in float32.
std::uint64_t changed_by_storing(const strata::MeshPairs& mesh) {
  if (mesh.in_doubles.empty() || mesh.rounding.beyond == 0) return 0;
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.size()), std::uint64_t{0},
      [&](const auto& range, std::uint64_t count) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
          count += intersects(mesh.double_pair(i)) != intersects(mesh.pair(i));
        return count;
      },
      std::plus<>());
}

// Measures the meshes, and names them in the scene.   text: receives a comment about what float32 would change.
Measured measured_meshes(const SceneVerb& options, std::string& text) {
  const auto found = std::make_shared<strata::MeshPairs>(
      strata::read_bodies({options.files.begin(), options.files.end()}, options.poses));
  const bool needs_doubles = !found->in_doubles.empty() && found->rounding.beyond > 0;
  const bool in_doubles = options.coordinates ? *options.coordinates == PairTypes::f64 : needs_doubles;
  say_notes(in_doubles && !options.exact_input ? found->notes_of_doubles : found->notes, found->rounding,
            options.exact_input);
  if (const std::uint64_t changed = changed_by_storing(*found); changed > 0) {
    const std::string count = fmt::format("{}{} of {} pairs have another verdict",
                                          in_doubles ? "" : "as the scene has them, ", changed, found->size());
    fmt::print(stderr, "graze: stored in float32, {}\n", count);
    text += fmt::format("# Stored in float32, {}{}.\n", count,
                        in_doubles ? "" : "; `graze scene --coordinates f64` keeps their doubles");
  }
  const auto sample_of = [&]<class Real>(const std::vector<std::array<Vec3<Real>, 3>>& triangles, const auto& pair) {
    return measured(analysis::BasicSceneSample<Real>{triangles, found->size(), pair}, options.files[0]);
  };
  Measured result;
  if (in_doubles) {
    result =
        sample_of(found->triangles_in_doubles(), [found](std::uint64_t index) { return found->double_pair(index); });
  } else {
    result = sample_of(found->triangles, [found](std::uint64_t index) { return found->pair(index); });
  }
  strata::SceneMeshes& meshes = result.scene.meshes;
  const fs::path folder = fs::path(options.out).parent_path();
  for (const std::string& file : options.files) meshes.files.push_back(relative_to(folder, file));
  if (!options.poses.empty()) meshes.poses = relative_to(folder, options.poses);
  meshes.content = found->content_hash;
  return result;
}

// Measures the input, and writes the scene to the --out file, or to standard output if none is given.
Measured write_scene(const SceneVerb& options) {
  for (const std::string& file : options.files) expect_utf8("graze scene", file);
  expect_utf8("--poses", options.poses);
  const bool pairs = fs::path(options.files[0]).extension() == ".pairs";
  if (pairs && options.files.size() > 1)
    throw UsageError(
        fmt::format("graze scene measures one file of pairs at a time, but got {} files", options.files.size()));
  if (!options.poses.empty() && (pairs || options.files.size() > 1))
    throw UsageError("--poses is for one mesh, but got " +
                     (pairs ? "pairs" : fmt::format("{} files", options.files.size())));
  std::string changed;
  Measured result = pairs ? measured_pairs(options.files[0], options) : measured_meshes(options, changed);
  result.scene.units = options.units;
  std::string text =
      "# Where graze draws pairs from. Edit it as you like: extent and edges are needed, all else has a default.\n";
  text += fmt::format("# Of {} triangles, {} pairs whose boxes overlap.\n", result.triangles, result.pairs);
  text += changed + strata::scene_text(result.scene);
  try {
    strata::parse_scene("scene", text);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("cannot write a scene of {}: {}", options.files[0], error.what()));
  }
  if (options.out.empty()) {
    std::cout << text;
  } else {
    write_result(options.out, text, fuzz::NamedBy::user);
  }
  return result;
}

void scene(const SceneVerb& options) {
  const Measured measured = write_scene(options);
  if (options.out.empty()) return;
  fmt::print("Wrote {}: {} triangles, {} pairs whose boxes overlap.\n", printable(options.out),
             reports::grouped(measured.triangles), reports::grouped(measured.pairs));
  if (options.sufficient > 0) print_sufficient(options.out, options.sufficient);
  fmt::print("Next: graze fuzz --scene {}\n", path_word(options.out));
}

}  // namespace

void write_scene_of(const std::string& mesh, const std::string& out, std::optional<PairTypes> type) {
  SceneVerb options;
  options.files = {mesh};
  options.out = out;
  options.coordinates = type;
  write_scene(options);
}

void add_scene(CLI::App& app, int&) {
  CLI::App* command = app.add_subcommand(
      "scene",
      "Measure meshes or pairs, and write a scene that pairs can be drawn from: extent, sizes, grid, kinds of pairs");
  command->footer(
      "Example: graze scene arm.off table.stl --units mm --out arm.toml\n"
      "Example: graze scene arm.toml --sufficient 1e-3");
  auto options = std::make_shared<SceneVerb>();
  command
      ->add_option(
          "FILE", options->files,
          "Meshes (" + strata::mesh_formats() +
              ") or one file of pairs (.pairs). One mesh is measured against itself, several against each other. With "
              "--sufficient also a scene (.toml)")
      ->required();
  add_valued(*command, "--poses", options->poses, "FILE",
             "CSV file of poses of the mesh, one per line: twelve numbers, the three rows of a matrix (R | t)");
  add_valued(*command, "--units", options->units, "NAME", "Unit of the coordinates")
      ->check(CLI::Validator(
          [](const std::string& text) {
            return strata::is_units(text) ? "" : "expected units of " + strata::kUnits + ", found " + shown(text);
          },
          ""))
      ->capture_default_str();
  add_valued(*command, "--out", options->out, "FILE", "File for the scene (default: standard output)");
  static_assert(static_cast<int>(PairTypes::f32) == 0 && static_cast<int>(PairTypes::f64) == 1);
  add_valued(*command, "--coordinates", options->coordinates, "f32|f64",
             "Coordinates of the scene: float32, or doubles as they are in the file")
      ->transform(one_of({"f32", "f64"}, Chosen::place))
      ->default_str("f64 if one has more digits than float32 holds");
  add_exact_input(*command, options->exact_input);
  add_valued(*command, "--sufficient", options->sufficient, "RATE",
             "Highest rate of wrong verdicts; finds the cheapest lane that stays within it in the scene")
      ->check(number(1e-6, 0.5));
  command->callback([options, command] {
    const bool is_scene = fs::path(options->files[0]).extension() == ".toml";
    if (options->sufficient > 0 && options->out.empty() != is_scene)
      throw UsageError(
          "--sufficient needs one scene: `graze scene SCENE.toml --sufficient RATE`, or `graze scene MESH… --out "
          "SCENE.toml --sufficient RATE`");
    if (!is_scene) return scene(*options);
    if (options->files.size() > 1 || options->sufficient == 0)
      throw UsageError("graze scene measures meshes or pairs; for an existing scene, add --sufficient");
    for (const char* measures : {"--poses", "--units", "--coordinates", "--exact-input"}) {
      if (command->count(measures) > 0)
        throw UsageError(std::string(measures) + " is for meshes and pairs that are measured, not for a scene");
    }
    print_sufficient(options->files[0], options->sufficient);
  });
}

strata::SceneSources drawn(const DrawOptions& options, fuzz::Json* recorded) {
  const auto& [pairs, seed, globs, types, scene] = options;
  if (scene.empty()) return {strata::stratum_sources(seed, pairs, globs, types), {}, {}, {}};
  expect_utf8("--scene", scene);
  const fuzz::NamedScene named{scene, strata::read_scene(scene)};
  strata::SceneSources drawn = fuzz::sources_of(named, seed, pairs, globs, types);
  if (recorded) *recorded = fuzz::scene_spec(named, pairs, drawn);
  return drawn;
}

void add_coordinates_option(CLI::App& command, PairTypes& types, OfBothTypes both) {
  static_assert(static_cast<int>(PairTypes::f32) == 0 && static_cast<int>(PairTypes::f64) == 1 &&
                static_cast<int>(PairTypes::both) == 2);
  command
      .add_option("--coordinates", types,
                  "Coordinates of the pairs. f64: doubles; lanes in double decide them unchanged, lanes in float "
                  "decide them rounded to float32; see docs/double.md")
      ->transform(both == OfBothTypes::yes ? one_of({"f32", "f64", "both"}, Chosen::place)
                                           : one_of({"f32", "f64"}, Chosen::place))
      ->option_text(both == OfBothTypes::yes ? "f32|f64|both" : "f32|f64")
      ->default_str("f32");
}

void add_draw_options(CLI::App& command, DrawOptions& options, OfBothTypes both) {
  add_globs(command, "--strata", options.strata, "Patterns of the strata to draw from");
  add_coordinates_option(command, options.coordinates, both);
  command.get_option("--coordinates")->default_str("f32, or those of the scene");
  add_valued(command, "--scene", options.scene, "FILE",
             "Scene file to draw pairs in, written by `graze scene` or by hand");
}

void take_type_of_scene(const CLI::App& command, DrawOptions& options) {
  if (options.scene.empty() || command.count("--coordinates") > 0) return;
  expect_utf8("--scene", options.scene);
  options.coordinates = type_of_scene(options.scene);
}

PairTypes type_of_scene(const std::string& scene) {
  return strata::read_scene(scene).in_doubles ? PairTypes::f64 : PairTypes::f32;
}

std::string left_out_text(const std::vector<strata::LeftOut>& left_out) {
  std::string text;
  for (const strata::LeftOut& row : left_out)
    text += fmt::format("{}  {}: {}\n", text.empty() ? "\nLeft out, because the scene cannot contain them:\n" : "",
                        row.id, row.why);
  return text;
}

}  // namespace graze::cli
