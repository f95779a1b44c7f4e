// SPDX-License-Identifier: Apache-2.0
// Tests that builds differ on the pairs of cuda/twin/canaries.pairs.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "core/lanes/lanes.h"
#include "corpus/pair_format.h"
#include "cuda/twin/twin.h"
#include "cuda/twin/twin_table.h"

namespace graze::cuda {

namespace twin_wrong {
extern const TwinTable kTwinTable;  // twins that contract the right product first
}

namespace {

const std::string& text(const corpus::Entry& entry, const char* key) {
  const std::string* value = corpus::field(entry, key);
  if (!value) throw std::runtime_error("a canary has no field " + std::string(key));
  return *value;
}

// The lane "ALGORITHM/SCALAR" of the canary in this variant.
const Lane& lane_of(const corpus::Entry& canary, Variant variant) {
  const std::string id = text(canary, "lane") + "/" + std::string(name(variant));
  if (const Lane* lane = find_lane(id)) return *lane;
  throw std::runtime_error("no lane " + id);
}

Verdict twin_says(const corpus::Entry& canary, Variant variant) {
  return decide_one(twin_row(lane_of(canary, variant)).decide, canary.pair);
}

std::vector<corpus::Entry> canaries(const std::string& kind) {
  std::vector<corpus::Entry> all = corpus::read_pairs(GRAZE_SOURCE_DIR "/cuda/twin/canaries.pairs");
  std::erase_if(all, [&](const corpus::Entry& entry) { return text(entry, "kind") != kind; });
  return all;
}

void expect_every_kernel(const std::vector<corpus::Entry>& entries) {
  std::set<std::string> kernels;
  for (const corpus::Entry& entry : entries) kernels.insert(text(entry, "lane"));
  EXPECT_EQ(kernels.size(), std::size_t{2} * kAlgorithmCount);
}

TEST(Canaries, CudaFmaAndCudaNofmaDiffer) {
  const std::vector<corpus::Entry> all = canaries("cuda_nofma");
  expect_every_kernel(all);
  for (const corpus::Entry& canary : all) {
    EXPECT_EQ(name(twin_says(canary, Variant::cuda_fma)), text(canary, "cuda_fma")) << text(canary, "name");
    EXPECT_EQ(name(twin_says(canary, Variant::cuda_nofma)), text(canary, "other")) << text(canary, "name");
    EXPECT_NE(text(canary, "cuda_fma"), text(canary, "other"));
  }
}

TEST(Canaries, AWrongContractionRuleIsCaught) {
  const std::vector<corpus::Entry> all = canaries("right_first");
  expect_every_kernel(all);
  for (const corpus::Entry& canary : all) {
    const Lane& lane = lane_of(canary, Variant::cuda_fma);
    const TwinRow& wrong =
        twin_wrong::kTwinTable.rows[static_cast<std::size_t>(lane.algorithm)][static_cast<std::size_t>(lane.scalar)];
    EXPECT_EQ(name(twin_says(canary, Variant::cuda_fma)), text(canary, "cuda_fma")) << text(canary, "name");
    EXPECT_NE(decide_one(wrong.decide, canary.pair), twin_says(canary, Variant::cuda_fma)) << text(canary, "name");
  }
}

TEST(Canaries, CpuFmaAndCudaFmaDiffer) {
#if defined(__clang__)
  const std::vector<corpus::Entry> all = canaries("cpu_fma_clang");
#else
  const std::vector<corpus::Entry> all = canaries("cpu_fma_gcc");
#endif
  ASSERT_FALSE(all.empty());
  if (!runs_on_this_cpu(lane_of(all[0], Variant::cpu_fma))) GTEST_SKIP() << "this processor has no FMA instructions";
  std::map<std::string, int> differ;
  for (const corpus::Entry& canary : all) {
    EXPECT_EQ(name(twin_says(canary, Variant::cuda_fma)), text(canary, "cuda_fma")) << text(canary, "name");
    differ[text(canary, "lane")] +=
        decide_one(lane_of(canary, Variant::cpu_fma).decide, canary.pair) != twin_says(canary, Variant::cuda_fma);
  }
  int lanes_that_differ = 0;
  for (const auto& [lane, count] : differ) {
    lanes_that_differ += count > 0;
#ifdef GRAZE_RELEASE_BUILD  // the host compiler's contractions depend on the optimisation level
    EXPECT_GT(count, 0) << lane;
#endif
  }
  EXPECT_GT(lanes_that_differ, 0);
}

// Even if the host's compiler contracts like nvcc, cpu-fma must differ from cpu.
TEST(Canaries, CpuFmaAndCpuDiffer) {
  std::map<std::string, int> differ;
  for (const char* kind : {"cuda_nofma", "cpu_fma_gcc", "cpu_fma_clang", "right_first"}) {
    for (const corpus::Entry& canary : canaries(kind)) {
      if (!runs_on_this_cpu(lane_of(canary, Variant::cpu_fma)))
        GTEST_SKIP() << "this processor has no FMA instructions";
      differ[text(canary, "lane")] += decide_one(lane_of(canary, Variant::cpu_fma).decide, canary.pair) !=
                                      decide_one(lane_of(canary, Variant::cpu).decide, canary.pair);
    }
  }
  EXPECT_EQ(differ.size(), std::size_t{2} * kAlgorithmCount);  // every lane has canaries
  for (const auto& [lane, count] : differ) EXPECT_GT(count, 0) << lane;
}

}  // namespace
}  // namespace graze::cuda
