// SPDX-License-Identifier: Apache-2.0
// The rows of `graze bench --between`. The exact decision and CGAL's do_intersect find all intersecting pairs of two
// meshes among the same candidates. The row "boxes alone" times the search for candidates, which is part of both times.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <stdexcept>

#include "cli/bench_rows.h"
#include "cli/cases.h"
#include "cli/mesh_pairs.h"
#include "cuda/query/device_query.h"
#include "oracle/cgal_triangles.h"
#include "strata/mesh.h"

namespace graze::cli {
namespace {

constexpr int kRuns = 3;
constexpr std::size_t kMostCompared = std::size_t{1} << 26;

struct Way {
  std::string lane;
  Decider decider;
};

void decide_none(Candidates& of) { std::fill(of.intersect.begin(), of.intersect.end(), 0); }

}  // namespace

void measure_between(const std::vector<std::string>& files, Bench& bench,
                     const std::function<bool(const Bench&)>& told) {
  const auto read = [](const std::string& file) {
    strata::MeshPairs mesh = strata::read_triangles(file);
    say_notes(mesh.notes, mesh.rounding, false);
    mesh.in_doubles.clear();  // CGAL and the exact decision get the triangles in float32
    mesh.rounding = {};
    return mesh;
  };
  const auto name = [](const std::string& file) { return std::filesystem::path(file).filename().string(); };
  const TwoMeshes meshes{read(files[0]), read(files[1])};
  const oracle::CgalTriangles a(meshes.a.triangles), b(meshes.b->triangles);
  const auto by_cgal = [&](Candidates& of) {
    decide_none(of);
    for (std::size_t k = 0; k < of.indices.size(); ++k) {
      const auto [i, j] = of.indices[k];
      of.intersect[k / 64] |= std::uint64_t{a.intersect(i, b, j)} << (k % 64);
    }
  };
  std::vector<Way> ways;
  for (const char* executor : {"one-core", "all-cores"}) {
    Decider decider = exact_decider(executor);
    if (decider.threads == 1 && executor == std::string("all-cores")) continue;
    ways.push_back({"exact", decider});
    decider.decide = by_cgal;
    ways.push_back({"CGAL do_intersect", decider});
    decider.decide = decide_none;
    ways.push_back({"boxes alone", decider});
  }
  std::string why_not;
  if (cuda::count_query_devices(why_not) > 0) ways.push_back({"exact", exact_decider("one-gpu")});

  const std::size_t group = bench.rows.empty() ? 0 : bench.rows.back().group + 1;
  std::vector<FoundPair> exact;
  for (const Way& way : ways) {
    const std::string executor = way.decider.executor == "one-gpu"    ? "one GPU"
                                 : way.decider.executor == "one-core" ? "one core"
                                                                      : "all cores";
    BenchRow row{group,
                 name(files[0]) + ", " + name(files[1]),
                 meshes.a.triangles.size() + meshes.b->triangles.size(),
                 executor,
                 "host",
                 "between",
                 way.lane,
                 1e9,
                 0,
                 0,
                 {},
                 1e9};
    FoundPairs found;
    for (int k = 0; k < kRuns; ++k) {
      found = find_pairs(meshes, way.decider, {kMostCompared});
      row.seconds = std::min(row.seconds, found.seconds);
      row.processor_seconds = std::min(row.processor_seconds, found.processor_seconds);
    }
    row.hits = found.all();
    if (row.hits > kMostCompared)
      throw std::runtime_error(
          fmt::format("{}: more than {} pairs intersect, too many to compare", row.array, kMostCompared));
    if (bench.rows.empty() || bench.rows.back().group != group) exact = found.pairs;
    if (way.lane != "boxes alone") {
      std::vector<FoundPair> differing;
      std::set_symmetric_difference(exact.begin(), exact.end(), found.pairs.begin(), found.pairs.end(),
                                    std::back_inserter(differing));
      row.mismatches = differing.size();
    }
    bench.rows.push_back(row);
    if (!told(bench)) throw std::runtime_error("interrupted");
  }
}

}  // namespace graze::cli
