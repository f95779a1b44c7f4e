// SPDX-License-Identifier: Apache-2.0
// Measures the time per pair of each of the oracle's decisions, by kind of pair.
#include <string>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <benchmark/benchmark.h>

#include "oracle/test_pairs.h"
#include "oracle/truth.h"

namespace graze::oracle {
namespace {

using oracle_test::Kind;
using oracle_test::PairSource;

struct Work {
  std::vector<Pair> pairs;
  std::vector<Verdict> verdicts;
};

Work work_of(Kind kind) {
  Work work;
  PairSource source(kind, 7);
  for (int i = 0; i < 4096; ++i) {
    work.pairs.push_back(source.next());
    work.verdicts.push_back(cgal_verdict(work.pairs.back()));
    if ((work.verdicts.back() == Verdict::intersects) != (gmp_contact(work.pairs.back()) != Contact::none)) {
      throw OracleMismatch("benchmark pair");
    }
  }
  return work;
}

// CGAL's own filtered test without our additions; only for triangles that are not flat.
bool raw_epick(const Pair& pair) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  const auto triangle = [](const Vec3<float>(&p)[3]) {
    const auto point = [](const Vec3<float>& v) { return Kernel::Point_3(v.x, v.y, v.z); };
    return Kernel::Triangle_3(point(p[0]), point(p[1]), point(p[2]));
  };
  return CGAL::do_intersect(triangle(pair.a), triangle(pair.b));
}

template <class Function>
void run(benchmark::State& state, Kind kind, const Function& function) {
  const Work work = work_of(kind);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(function(work.pairs[i], work.verdicts[i]));
    i = (i + 1) % work.pairs.size();
  }
  state.SetItemsProcessed(state.iterations());
}

const bool kRegistered = [] {
  struct Named {
    const char* name;
    Kind kind;
  };
  for (const auto& [name, kind] :
       {Named{"uniform", Kind::uniform}, Named{"near", Kind::near}, Named{"coplanar", Kind::coplanar},
        Named{"touching", Kind::touching}, Named{"lattice", Kind::lattice3}, Named{"raw_bits", Kind::raw_bits}}) {
    const auto add = [name, kind](const char* function_name, auto function) {
      benchmark::RegisterBenchmark((std::string(function_name) + "/" + name).c_str(),
                                   [kind, function](benchmark::State& state) { run(state, kind, function); });
    };
    add("cgal_verdict", [](const Pair& pair, Verdict) { return cgal_verdict(pair); });
    if (kind != Kind::lattice3) add("raw_epick", [](const Pair& pair, Verdict) { return raw_epick(pair); });
    add("gmp_contact", [](const Pair& pair, Verdict) { return gmp_contact(pair); });
    add("margin_bucket", [](const Pair& pair, Verdict verdict) { return margin_bucket(pair, verdict); });
    add("truth", [](const Pair& pair, Verdict) { return truth(pair); });
  }
  return true;
}();

}  // namespace
}  // namespace graze::oracle
