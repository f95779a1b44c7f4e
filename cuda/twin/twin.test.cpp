// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/twin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "core/lanes/verdicts.h"
#include "cuda/lanes/trace.h"
#include "cuda/twin/twin_table.h"
#include "strata/strata.h"

namespace graze::cuda {
namespace {

constexpr std::uint64_t kSeed = 3;

// Pairs from every stratum: random, near-touching, coplanar, degenerate, and of extreme scale.
const std::vector<Pair>& sample() {
  static const std::vector<Pair> pairs = [] {
    std::vector<Pair> all;
    for (int s = 0; s < strata::kStrataCount; ++s) {
      for (std::uint64_t i = 0; i < 8000; ++i) all.push_back(strata::generate(kSeed, strata::kStrata[s].stratum, i));
    }
    return all;
  }();
  return pairs;
}

std::string test_name(const std::string& id) {
  std::string name = id;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
  return name;
}

class Twin : public testing::TestWithParam<const Lane*> {
 protected:
  const Lane& lane() const { return *GetParam(); }
  const Lane& sibling(Variant variant) const { return *counterpart(lane(), variant); }
  DecideBlock twin(Variant variant) const { return twin_row(sibling(variant)).decide; }
};

// The tests' parameters: one lane for each algorithm and scalar.
std::vector<const Lane*> cuda_fma_lanes() {
  std::vector<const Lane*> rows;
  for (const Lane& lane : lanes()) {
    if (lane.variant == Variant::cuda_fma) rows.push_back(&lane);
  }
  return rows;
}

INSTANTIATE_TEST_SUITE_P(Lanes, Twin, testing::ValuesIn(cuda_fma_lanes()),
                         [](const auto& row) { return test_name(row.param->id); });

TEST_P(Twin, EveryCudaLaneHasOne) {
  for (Variant variant : {Variant::cuda_fma, Variant::cuda_nofma}) {
    EXPECT_NE(twin(variant), nullptr);
    EXPECT_NE(twin_row(sibling(variant)).trace, nullptr);
    EXPECT_EQ(std::strlen(twin_row(sibling(variant)).hash), 16u);
    EXPECT_TRUE(twin_evidence(sibling(variant)).starts_with("twin"));
  }
  EXPECT_EQ(twin(Variant::cpu), nullptr);
  EXPECT_STRNE(twin_row(sibling(Variant::cuda_fma)).hash, twin_row(sibling(Variant::cuda_nofma)).hash);
}

// The evidence has the record's pair counts: those decided by GPU and twin, and those decided by two builds on the GPU.
TEST_P(Twin, EvidenceSaysWhatTheRecordSays) {
  const auto record =
      nlohmann::json::parse(std::ifstream(GRAZE_SOURCE_DIR "/cuda/proofs/nvidia_h100_nvcc_13.0.88.json"));
  int told = 0;
  for (Variant variant : {Variant::cuda_fma, Variant::cuda_nofma}) {
    const TwinRow& row = twin_row(sibling(variant));
    for (const auto& proven : record.at("lanes")) {
      if (proven.at("hash") != row.hash || proven.at("trace_hash") != row.trace_hash) continue;
      std::ostringstream words;
      words << "twin, verified on " << record.at("device").get<std::string>() << ", nvcc "
            << record.at("toolkit").get<std::string>() << ": GPU and twin agree on "
            << proven.at("twin_pairs").get<double>() << " pairs, the GPU's default build and explicit PTX on "
            << proven.at("pairs").get<double>();
      EXPECT_EQ(twin_evidence(sibling(variant)), words.str());
      ++told;
    }
  }
  EXPECT_EQ(told, 2);
}

TEST(TwinEvidence, IsOfWhatWasCompared) {
  EXPECT_EQ(evidence(TwinProof{"GPU", "1.2", 0, 1500}),
            "twin, verified on GPU, nvcc 1.2: GPU and twin agree on 1.5e+03 pairs");
  EXPECT_EQ(evidence(TwinProof{"GPU", "1.2", 4e9, 30}),
            "twin, verified on GPU, nvcc 1.2: GPU and twin agree on 30 pairs, the GPU's default build and explicit PTX "
            "on 4e+09");
}

TEST_P(Twin, WithoutContractionIsTheCpuLane) {
  ASSERT_GE(sample().size(), 100'000u);
  EXPECT_TRUE(verdicts_of(twin(Variant::cuda_nofma), sample()) == verdicts_of(sibling(Variant::cpu).decide, sample()));
}

// The trace hash of the cpu lane's algorithm, compiled for this processor without contraction.
template <class Algorithm, class Real>
std::uint64_t traced(const Pair& pair) {
  Vec3<Real> a[3], b[3];
  for (int i = 0; i < 3; ++i) {
    a[i] = {Real(pair.a[i].x), Real(pair.a[i].y), Real(pair.a[i].z)};
    b[i] = {Real(pair.b[i].x), Real(pair.b[i].y), Real(pair.b[i].z)};
  }
  std::uint64_t hash = 0;
  const Verdict verdict = Algorithm::decide(a, b, TracePolicy{&hash});
  return hash ^ static_cast<std::uint64_t>(verdict);
}

template <class... Algorithm>
std::uint64_t traced(int algorithm, Scalar scalar, const Pair& pair, const std::tuple<Algorithm...>*) {
  using Trace = std::uint64_t (*)(const Pair&);
  static constexpr Trace kTraces[][2] = {{traced<Algorithm, float>, traced<Algorithm, double>}...};
  return kTraces[algorithm][static_cast<int>(scalar)](pair);
}

TEST_P(Twin, WithoutContractionHasTheCpuLanesIntermediateBits) {
  std::vector<std::uint64_t> hashes(sample().size());
  twin_row(sibling(Variant::cuda_nofma)).trace(sample().data(), sample().size(), hashes.data());
  int differ = 0;
  for (std::size_t i = 0; i < hashes.size(); ++i) {
    differ +=
        hashes[i] != traced(lane().algorithm, lane().scalar, sample()[i], static_cast<const Algorithms*>(nullptr));
  }
  EXPECT_EQ(differ, 0);
}

TEST_P(Twin, ContractionChangesIntermediateBits) {
  std::vector<std::uint64_t> fused(sample().size()), unfused(sample().size());
  twin_row(sibling(Variant::cuda_fma)).trace(sample().data(), sample().size(), fused.data());
  twin_row(sibling(Variant::cuda_nofma)).trace(sample().data(), sample().size(), unfused.data());
  EXPECT_NE(fused, unfused);
}

TEST_P(Twin, WithFmaFromTheLibraryIsTheSame) {
  const auto a = static_cast<std::size_t>(lane().algorithm), s = static_cast<std::size_t>(lane().scalar);
  EXPECT_TRUE(verdicts_of(twin_cuda_fma_portable::kTwinTable.rows[a][s].decide, sample()) ==
              verdicts_of(twin(Variant::cuda_fma), sample()));
}

TEST_P(Twin, FusingAllSitesIsCudaFmaAndNoneIsCudaNofma) {
  const std::size_t sites = contraction_sites(lane()).size();
  ASSERT_GT(sites, 0u);
  const std::vector<std::uint64_t> none((sites + 63) / 64, 0), all((sites + 63) / 64, ~std::uint64_t{0});
  const std::vector<Verdict> fused = verdicts_of(twin(Variant::cuda_fma), sample()),
                             unfused = verdicts_of(twin(Variant::cuda_nofma), sample());
  int wrong = 0;
  for (std::size_t i = 0; i < sample().size(); ++i) {
    wrong += decide_fusing(lane(), sample()[i], all) != fused[i];
    wrong += decide_fusing(lane(), sample()[i], none) != unfused[i];
  }
  EXPECT_EQ(wrong, 0);
}

TEST_P(Twin, SitesHaveTheirLines) {
  bool by_ptxas = false, by_front_end = false;
  for (const ContractionSite& site : contraction_sites(lane())) {
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(GRAZE_SOURCE_DIR) / site.at.file)) << site.at.file;
    EXPECT_GT(site.at.line, 0);
    (site.by_ptxas ? by_ptxas : by_front_end) = true;
  }
  EXPECT_TRUE(by_ptxas && by_front_end);
}

TEST(Twin, DecideFusingRefusesTooFewBits) {
  EXPECT_THROW(decide_fusing(*find_lane("projected_sat/f32/cuda-fma"), Pair{}, {}), std::invalid_argument);
}

TEST(Twin, BlocksOfAnyLengthFillWholeWords) {
  const DecideBlock decide = twin_row(*find_lane("interval_overlap/f32/cuda-fma")).decide;
  for (std::size_t n : {std::size_t{1}, std::size_t{63}, std::size_t{64}, std::size_t{65}}) {
    std::vector<std::uint64_t> yes(2, ~std::uint64_t{0}), declined(2, ~std::uint64_t{0});
    decide(sample().data(), n, yes.data(), declined.data());
    if (n < 64) {
      EXPECT_EQ(yes[0] >> n, 0u);
    }
    EXPECT_EQ(yes[1] == ~std::uint64_t{0}, n <= 64);
  }
}

}  // namespace
}  // namespace graze::cuda
