// SPDX-License-Identifier: Apache-2.0
// Plants a defect in a lane; a campaign must find it. The defects that are planted in our own sources are in
// scripts/mutants.toml.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/run_graze.h"
#include "core/fnv1a.h"
#include "corpus/pair_format.h"
#include "strata/pair_source.h"

namespace graze::cli {
namespace {

class PlantedDefect : public CommandTest {};

bool is_flipped(const Pair& pair) {
  return fnv1a(std::string_view(reinterpret_cast<const char*>(coordinates(pair)), sizeof(Pair))) % 100'000 == 0;
}

// The lane is exact, but inverts one verdict in 10^5. Each inverted verdict must be counted, and its pair kept.
TEST_F(PlantedDefect, ALaneThatFlipsOneVerdictInAHundredThousandIsFound) {
  std::ofstream(shell.folder / "flips.cpp") << R"(#include <string_view>
#include "core/exact/exact.h"
#include "core/fnv1a.h"
extern "C" int flips(const float a[9], const float b[9]) {
  float all[18];
  for (int i = 0; i < 9; ++i) all[i] = a[i], all[9 + i] = b[i];
  const bool flipped = graze::fnv1a(std::string_view(reinterpret_cast<const char*>(all), sizeof all)) % 100000 == 0;
  return graze::exact::intersects(a, b) != flipped;
})";
  expect_done("g++ -std=c++20 -O2 -ffp-contract=off -shared -fPIC -I" GRAZE_SOURCE_DIR " flips.cpp -o flips.so");
  std::vector<std::string> planted;
  for (const strata::PairSource& source : strata::stratum_sources(4, 400'000, {"uniform", "shared_edge"})) {
    for (std::uint64_t i = 0; i < source.pairs; ++i) {
      if (is_flipped(source.pair(i))) planted.push_back(source.id + ":4:" + std::to_string(i));
    }
  }
  ASSERT_GE(planted.size(), 2u);
  expect_done(
      "graze fuzz --subject flips=flips.so:flips --lanes 'flips/*' --strata uniform,shared_edge --pairs 400k --seed 4 "
      "--out c");
  const auto summary = shell.json("c/summary.json");
  EXPECT_EQ(summary["disagreements"], planted.size());
  std::vector<std::string> found;
  for (const auto& file : std::filesystem::directory_iterator(shell.folder / "c/cases")) {
    for (const corpus::Entry& entry : corpus::read_pairs(file.path())) found.push_back(corpus::origin_of(entry));
  }
  std::sort(found.begin(), found.end());
  std::sort(planted.begin(), planted.end());
  EXPECT_EQ(found, planted);
}

}  // namespace
}  // namespace graze::cli
