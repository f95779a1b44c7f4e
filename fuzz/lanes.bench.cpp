// SPDX-License-Identifier: Apache-2.0
// Time per pair of every host lane on every stratum. For comparison, the time of CGAL's do_intersect on ready-made
// triangles, and of the oracle's two decisions. GRAZE_MESH=FILE adds the candidate pairs of a mesh as a stratum.
// Exact lanes must first agree with the oracle on every pair that is timed.
#include <algorithm>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <benchmark/benchmark.h>

#include "build_info.h"
#include "core/lanes/lanes.h"
#include "oracle/truth.h"
#include "strata/mesh.h"
#include "strata/strata.h"

namespace graze::fuzz {
namespace {

constexpr std::size_t kPairs = 1 << 14;  // 1.2 MB: too many branches for the predictor, but fits in the cache

struct Block {
  std::vector<Pair> pairs;
  std::vector<std::uint64_t> intersects;  // the truth: bit i % 64 of word i / 64
};

struct PairsToTime {
  std::string id;
  Block all;
  Block proper;  // pairs without degenerate triangles, as CGAL's do_intersect requires
};

// Writes one bit for each pair, as lanes do.
template <class Decide>
void by_pair(std::size_t count, std::uint64_t* intersects, const Decide& decide) {
  std::fill_n(intersects, (count + 63) / 64, 0);
  for (std::size_t i = 0; i < count; ++i) intersects[i / 64] |= std::uint64_t{decide(i)} << i % 64;
}

Block block_of(std::vector<Pair> pairs) {
  Block block{std::move(pairs), {}};
  block.intersects.resize((block.pairs.size() + 63) / 64);
  by_pair(block.pairs.size(), block.intersects.data(),
          [&](std::size_t i) { return oracle::cgal_verdict(block.pairs[i]) == Verdict::intersects; });
  return block;
}

PairsToTime source_of(std::string id, std::vector<Pair> pairs) {
  std::vector<Pair> proper;
  std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(proper), [](const Pair& pair) {
    const Hulls hulls = oracle::hulls(pair);
    return hulls.dimension_a == 2 && hulls.dimension_b == 2;
  });
  return {std::move(id), block_of(std::move(pairs)), block_of(std::move(proper))};
}

std::vector<PairsToTime> make_sources() {
  std::vector<PairsToTime> sources;
  std::vector<Pair> pairs(kPairs);
  for (const strata::StratumInfo& row : strata::kStrata) {
    for (std::size_t i = 0; i < kPairs; ++i) pairs[i] = strata::generate(1, row.stratum, i);
    sources.push_back(source_of(std::string(row.id), pairs));
  }
  if (const char* file = std::getenv("GRAZE_MESH"); file && *file) {
    const strata::MeshPairs mesh = strata::read_mesh_pairs(file);
    pairs.resize(std::min(kPairs, mesh.size()));  // spread over the mesh
    for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = mesh.pair(i * mesh.size() / pairs.size());
    if (!pairs.empty()) sources.push_back(source_of("mesh", pairs));
  }
  return sources;
}

using Decide = std::function<void(const Block&, std::uint64_t* intersects, std::uint64_t* declined)>;

void measure(benchmark::State& state, const Block& block, bool exact, const Decide& decide) {
  const std::vector<std::uint64_t> none(block.intersects.size());
  std::vector<std::uint64_t> intersects = none, declined = none;
  decide(block, intersects.data(), declined.data());
  if (exact && (intersects != block.intersects || declined != none))
    return state.SkipWithError("differs from the oracle");
  for (auto _ : state) {
    decide(block, intersects.data(), declined.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * block.pairs.size()));
  state.counters["pairs"] = static_cast<double>(block.pairs.size());
}

// Triangles are made once for all runs on a block, because EPECK's points cache their exact coordinates.
template <class Kernel>
void by_cgal(const Block& block, std::uint64_t* intersects, std::uint64_t*) {
  using Triangle = typename Kernel::Triangle_3;
  static const Block* made_for = nullptr;
  static std::vector<Triangle> triangles;
  if (made_for != &block) {
    const auto triangle = [](const Vec3<float>(&p)[3]) {
      const auto point = [](const Vec3<float>& v) { return typename Kernel::Point_3(v.x, v.y, v.z); };
      return Triangle(point(p[0]), point(p[1]), point(p[2]));
    };
    triangles.clear();
    for (const Pair& pair : block.pairs) {
      triangles.push_back(triangle(pair.a));
      triangles.push_back(triangle(pair.b));
    }
    made_for = &block;
  }
  by_pair(block.pairs.size(), intersects,
          [](std::size_t i) { return CGAL::do_intersect(triangles[2 * i], triangles[2 * i + 1]); });
}

void add(const std::string& decision, const std::string& source, const Block& block, bool exact, Decide decide) {
  benchmark::RegisterBenchmark((decision + '/' + source).c_str(), [=, &block](benchmark::State& state) {
    measure(state, block, exact, decide);
  })->Unit(benchmark::kMicrosecond);
}

void add_source(const PairsToTime& source) {
  for (const Lane& lane : lanes()) {
    if (!lane.decide || !runs_on_this_cpu(lane)) continue;
    const Decide decide = [&lane](const Block& block, std::uint64_t* intersects, std::uint64_t* declined) {
      lane.decide(block.pairs.data(), block.pairs.size(), intersects, declined);
    };
    add(lane.id, source.id, source.all, lane.exact, decide);
    if (lane.exact && !source.proper.pairs.empty()) add(lane.id + ",proper", source.id, source.proper, true, decide);
  }
  if (!source.proper.pairs.empty()) {
    add("cgal_epick", source.id, source.proper, true, by_cgal<CGAL::Exact_predicates_inexact_constructions_kernel>);
    add("cgal_epeck", source.id, source.proper, true, by_cgal<CGAL::Exact_predicates_exact_constructions_kernel>);
  }
  add("cgal_verdict", source.id, source.all, true, [](const Block& block, std::uint64_t* intersects, std::uint64_t*) {
    by_pair(block.pairs.size(), intersects,
            [&](std::size_t i) { return oracle::cgal_verdict(block.pairs[i]) == Verdict::intersects; });
  });
  add("gmp_contact", source.id, source.all, true, [](const Block& block, std::uint64_t* intersects, std::uint64_t*) {
    by_pair(block.pairs.size(), intersects,
            [&](std::size_t i) { return oracle::gmp_contact(block.pairs[i]) != Contact::none; });
  });
}

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(": ") + 2);
  }
  return "unknown processor";
}

}  // namespace
}  // namespace graze::fuzz

int main(int argc, char** argv) try {
  benchmark::AddCustomContext("processor", graze::fuzz::processor());
  benchmark::AddCustomContext("compiler", GRAZE_COMPILER);
  benchmark::AddCustomContext("flags", GRAZE_FLAGS);
  benchmark::AddCustomContext("commit", GRAZE_COMMIT);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  const std::vector<graze::fuzz::PairsToTime> sources = graze::fuzz::make_sources();
  for (const graze::fuzz::PairsToTime& source : sources) graze::fuzz::add_source(source);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
} catch (const std::exception& error) {
  std::cerr << "graze_fuzz_bench: " << error.what() << '\n';
  return 1;
}
