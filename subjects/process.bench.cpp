// SPDX-License-Identifier: Apache-2.0
// Measures the overhead of the processes around foreign code. The function does almost nothing, and is called twice for
// each pair.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "strata/strata.h"
#include "subjects/process.h"

namespace graze::subjects {
namespace {

void cheap_function(benchmark::State& state) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "graze-subjects-bench";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "cheap.c") << "int intersects(const float* a, const float* b) { return a[0] < b[0]; }";
  const std::string library = (folder / "cheap.so").string();
  if (std::system(("cc -O2 -shared -fPIC " + (folder / "cheap.c").string() + " -o " + library).c_str()) != 0)
    return state.SkipWithError("cannot compile the subject: the command cc failed; install a C compiler");
  ForeignProcesses subject({"library", library, "intersects", "f32"}, Scalar::f32);
  std::vector<Pair> pairs;
  for (std::uint64_t i = 0; i < 65536; ++i) pairs.push_back(strata::generate(1, strata::Stratum::uniform, i));
  std::vector<std::uint64_t> intersects(pairs.size() / 64), declined(intersects.size());
  for (auto _ : state) {
    subject.decide(pairs.data(), pairs.size(), intersects.data(), declined.data());
    if (declined[0] != 0) state.SkipWithError("the subject gave no answers");
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(pairs.size()));
  std::filesystem::remove_all(folder);
}
BENCHMARK(cheap_function)->UseRealTime();

}  // namespace
}  // namespace graze::subjects
