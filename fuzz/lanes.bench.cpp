// SPDX-License-Identifier: Apache-2.0
// Measures every host lane's time per pair on float32 strata, and double-precision lanes' time on strata of doubles.
// Also measures CGAL's do_intersect on triangles constructed beforehand, and the oracle's two decisions.
// GRAZE_MESH=FILE adds a mesh's candidate pairs as a stratum. An exact lane is timed only if it agrees with the oracle.
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
#include "strata/pair_source.h"
#include "strata/strata.h"

namespace graze::fuzz {
namespace {

constexpr std::size_t kPairs = 1 << 14;  // 1.2 MB: fits in the cache, but has too many branches for the predictor

template <class Real>
struct Block {
  std::vector<BasicPair<Real>> pairs;
  std::vector<std::uint64_t> intersects;  // the truth: bit i % 64 of word i / 64
};

template <class Real>
struct PairsToTime {
  std::string id;
  Block<Real> all;
  Block<Real> proper;  // no degenerate triangles, because CGAL's do_intersect rejects them
};

// Writes one bit for each pair, as lanes do.
template <class Decide>
void by_pair(std::size_t count, std::uint64_t* intersects, const Decide& decide) {
  std::fill_n(intersects, (count + 63) / 64, 0);
  for (std::size_t i = 0; i < count; ++i) intersects[i / 64] |= std::uint64_t{decide(i)} << i % 64;
}

template <class Real>
Block<Real> block_of(std::vector<BasicPair<Real>> pairs) {
  Block<Real> block{std::move(pairs), {}};
  block.intersects.resize((block.pairs.size() + 63) / 64);
  by_pair(block.pairs.size(), block.intersects.data(),
          [&](std::size_t i) { return oracle::cgal_verdict(block.pairs[i]) == Verdict::intersects; });
  return block;
}

template <class Real>
PairsToTime<Real> source_of(std::string id, std::vector<BasicPair<Real>> pairs) {
  std::vector<BasicPair<Real>> proper;
  std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(proper), [](const BasicPair<Real>& pair) {
    const Hulls hulls = oracle::hulls(pair);
    return hulls.dimension_a == 2 && hulls.dimension_b == 2;
  });
  return {std::move(id), block_of(std::move(pairs)), block_of(std::move(proper))};
}

std::vector<PairsToTime<float>> make_sources() {
  std::vector<PairsToTime<float>> sources;
  std::vector<Pair> pairs(kPairs);
  for (const strata::StratumInfo& row : strata::kStrata) {
    for (std::size_t i = 0; i < kPairs; ++i) pairs[i] = strata::generate(1, row.stratum, i);
    sources.push_back(source_of(std::string(row.id), pairs));
  }
  if (const char* file = std::getenv("GRAZE_MESH"); file && *file) {
    const strata::MeshPairs mesh = strata::read_bodies({file});
    pairs.resize(std::min(kPairs, mesh.size()));  // evenly spaced in the mesh
    for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = mesh.pair(i * mesh.size() / pairs.size());
    if (!pairs.empty()) sources.push_back(source_of("mesh", pairs));
  }
  return sources;
}

std::vector<PairsToTime<double>> make_double_sources() {
  std::vector<PairsToTime<double>> sources;
  std::vector<DoublePair> pairs(kPairs);
  for (const strata::StratumInfo& row : strata::kDoubleStrata) {
    for (std::size_t i = 0; i < kPairs; ++i) pairs[i] = strata::generate_doubles(1, row.stratum, i);
    sources.push_back(source_of(std::string(row.id) + std::string(strata::kInDoubles), pairs));
  }
  return sources;
}

template <class Real>
using Decide = std::function<void(const Block<Real>&, std::uint64_t* intersects, std::uint64_t* declined)>;

template <class Real>
void measure(benchmark::State& state, const Block<Real>& block, bool exact, const Decide<Real>& decide) {
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

// Triangles are created once for all runs on a block, because EPECK's points cache their exact coordinates.
template <class Kernel, class Real>
void by_cgal(const Block<Real>& block, std::uint64_t* intersects, std::uint64_t*) {
  using Triangle = typename Kernel::Triangle_3;
  static const Block<Real>* made_for = nullptr;
  static std::vector<Triangle> triangles;
  if (made_for != &block) {
    const auto triangle = [](const Vec3<Real>(&p)[3]) {
      const auto point = [](const Vec3<Real>& v) { return typename Kernel::Point_3(v.x, v.y, v.z); };
      return Triangle(point(p[0]), point(p[1]), point(p[2]));
    };
    triangles.clear();
    for (const BasicPair<Real>& pair : block.pairs) {
      triangles.push_back(triangle(pair.a));
      triangles.push_back(triangle(pair.b));
    }
    made_for = &block;
  }
  by_pair(block.pairs.size(), intersects,
          [](std::size_t i) { return CGAL::do_intersect(triangles[2 * i], triangles[2 * i + 1]); });
}

template <class Real>
void add(const std::string& decision, const std::string& source, const Block<Real>& block, bool exact,
         Decide<Real> decide) {
  benchmark::RegisterBenchmark((decision + '/' + source).c_str(), [=, &block](benchmark::State& state) {
    measure(state, block, exact, decide);
  })->Unit(benchmark::kMicrosecond);
}

template <class Real>
void add_source(const PairsToTime<Real>& source) {
  using Bits = std::uint64_t*;
  for (const Lane& lane : lanes()) {
    if (!lane.decide || !runs_on_this_cpu(lane)) continue;
    if (std::is_same_v<Real, double> && !lane.decide.decides_doubles()) continue;
    const Decide<Real> decide = [&lane](const Block<Real>& block, Bits intersects, Bits declined) {
      lane.decide(block.pairs.data(), block.pairs.size(), intersects, declined);
    };
    add(lane.id, source.id, source.all, lane.exact, decide);
    if (lane.exact && !source.proper.pairs.empty()) add(lane.id + ",proper", source.id, source.proper, true, decide);
  }
  if (!source.proper.pairs.empty()) {
    using Epick = CGAL::Exact_predicates_inexact_constructions_kernel;
    using Epeck = CGAL::Exact_predicates_exact_constructions_kernel;
    add<Real>("cgal_epick", source.id, source.proper, true, by_cgal<Epick, Real>);
    add<Real>("cgal_epeck", source.id, source.proper, true, by_cgal<Epeck, Real>);
  }
  add<Real>("cgal_verdict", source.id, source.all, true, [](const Block<Real>& block, Bits intersects, Bits) {
    by_pair(block.pairs.size(), intersects,
            [&](std::size_t i) { return oracle::cgal_verdict(block.pairs[i]) == Verdict::intersects; });
  });
  add<Real>("gmp_contact", source.id, source.all, true, [](const Block<Real>& block, Bits intersects, Bits) {
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
  const auto sources = graze::fuzz::make_sources();
  const auto of_doubles = graze::fuzz::make_double_sources();
  for (const auto& source : sources) graze::fuzz::add_source(source);
  for (const auto& source : of_doubles) graze::fuzz::add_source(source);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
} catch (const std::exception& error) {
  std::cerr << "graze_fuzz_bench: " << error.what() << '\n';
  return 1;
}
