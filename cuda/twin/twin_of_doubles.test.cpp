// SPDX-License-Identifier: Apache-2.0
// Tests the twins of kernels that decide pairs of doubles.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/discrepancy/count.h"
#include "core/discrepancy/questions.h"
#include "core/lanes/verdicts.h"
#include "cuda/lanes/trace.h"
#include "cuda/twin/twin_table.h"
#include "strata/strata.h"

namespace graze::cuda {
namespace {

// Pairs from every stratum of doubles.
const std::vector<DoublePair>& double_sample() {
  static const std::vector<DoublePair> pairs = [] {
    std::vector<DoublePair> all;
    for (const strata::StratumInfo& stratum : strata::kDoubleStrata) {
      for (std::uint64_t i = 0; i < 5000; ++i) all.push_back(strata::generate_doubles(5, stratum.stratum, i));
    }
    return all;
  }();
  return pairs;
}

std::vector<Verdict> verdicts_in_double(const DecideBlock& decide) { return verdicts_of(decide, double_sample()); }

class TwinOfDoubles : public testing::TestWithParam<const Lane*> {
 protected:
  const Lane& lane() const { return *GetParam(); }
  const Lane& sibling(Variant variant) const { return *counterpart(lane(), variant); }
};

std::vector<const Lane*> fused_lanes_in_double() {
  std::vector<const Lane*> rows;
  for (const Lane& lane : lanes()) {
    if (lane.variant == Variant::cuda_fma && lane.scalar == Scalar::f64) rows.push_back(&lane);
  }
  return rows;
}

INSTANTIATE_TEST_SUITE_P(Lanes, TwinOfDoubles, testing::ValuesIn(fused_lanes_in_double()),
                         [](const auto& row) { return parse_lane_name(row.param->id)->subject; });

TEST_P(TwinOfDoubles, WithoutContractionIsTheCpuLane) {
  ASSERT_GE(double_sample().size(), 100'000u);
  EXPECT_TRUE(verdicts_in_double(block_on_host(sibling(Variant::cuda_nofma))) ==
              verdicts_in_double(sibling(Variant::cpu).decide));
}

// The trace hash of the cpu lane's algorithm, compiled for this processor without contraction.
template <class... Algorithm>
std::uint64_t traced_in_double(int algorithm, const DoublePair& pair, const std::tuple<Algorithm...>*) {
  using Trace = std::uint64_t (*)(const DoublePair&);
  static constexpr Trace kTraces[] = {[](const DoublePair& of) {
    std::uint64_t hash = 0;
    const Verdict verdict = Algorithm::decide(of.a, of.b, TracePolicy{&hash});
    return hash ^ static_cast<std::uint64_t>(verdict);
  }...};
  return kTraces[algorithm](pair);
}

TEST_P(TwinOfDoubles, WithoutContractionHasTheCpuLanesIntermediateBits) {
  const std::vector<DoublePair>& pairs = double_sample();
  std::vector<std::uint64_t> hashes(pairs.size());
  twin_row(sibling(Variant::cuda_nofma)).doubles.trace(pairs.data(), pairs.size(), hashes.data());
  int differ = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    differ += hashes[i] != traced_in_double(lane().algorithm, pairs[i], static_cast<const Algorithms*>(nullptr));
  EXPECT_EQ(differ, 0);
}

TEST_P(TwinOfDoubles, ContractionChangesVerdicts) {
  EXPECT_NE(verdicts_in_double(block_on_host(lane())), verdicts_in_double(block_on_host(sibling(Variant::cuda_nofma))));
}

TEST_P(TwinOfDoubles, DecidesFloatsAsTheTwinOfFloats) {
  std::vector<Pair> floats;
  std::vector<DoublePair> doubles;
  for (std::uint64_t i = 0; i < 20'000; ++i) {
    floats.push_back(strata::generate(7, strata::kStrata[i % strata::kStrataCount].stratum, i));
    doubles.push_back(in_doubles(floats.back()));
  }
  std::vector<std::uint64_t> hashes(floats.size()), of_doubles(floats.size());
  twin_row(lane()).trace(floats.data(), floats.size(), hashes.data());
  twin_row(lane()).doubles.trace(doubles.data(), doubles.size(), of_doubles.data());
  EXPECT_EQ(hashes, of_doubles);
}

TEST_P(TwinOfDoubles, FusingAllSitesIsCudaFmaAndNoneIsCudaNofma) {
  const std::size_t sites = contraction_sites(lane(), double_sample()[0]).size();
  ASSERT_GT(sites, 0u);
  const std::vector<std::uint64_t> none((sites + 63) / 64, 0), all((sites + 63) / 64, ~std::uint64_t{0});
  const std::vector<Verdict> fused = verdicts_in_double(block_on_host(lane())),
                             unfused = verdicts_in_double(block_on_host(sibling(Variant::cuda_nofma)));
  int wrong = 0;
  for (std::size_t i = 0; i < fused.size(); ++i) {
    wrong += decide_fusing(lane(), double_sample()[i], all) != fused[i];
    wrong += decide_fusing(lane(), double_sample()[i], none) != unfused[i];
  }
  EXPECT_EQ(wrong, 0);
}

TEST_P(TwinOfDoubles, UnderTolerancesIsTheCpuLaneWithoutContractionAndAnotherWithIt) {
  if (!has_policy_twins()) GTEST_SKIP() << "built without twins of lanes under tolerances";
  bool contraction_matters = false;
  for (const char* policy : {"abs:1e-9", "rel:16", "plane_distance=rel:3,separation=abs:1e-12"}) {
    const auto verdicts = [&](Variant variant) {
      return verdicts_in_double(block_on_host(lane_under(sibling(variant), policy)));
    };
    const std::vector<Verdict> of_cpu = verdicts(Variant::cpu);
    EXPECT_TRUE(verdicts(Variant::cuda_nofma) == of_cpu) << policy;
    EXPECT_FALSE(of_cpu == verdicts_in_double(block_on_host(sibling(Variant::cpu)))) << policy;
    contraction_matters = contraction_matters || verdicts(Variant::cuda_fma) != of_cpu;
  }
  EXPECT_TRUE(contraction_matters);
}

TEST_P(TwinOfDoubles, WithFmaFromTheLibraryIsTheSame) {
  const TwinRow& portable = twin_cuda_fma_portable::kTwinTable.rows[static_cast<std::size_t>(lane().algorithm)][1];
  EXPECT_TRUE(verdicts_in_double({{portable.decide}, {portable.doubles.decide}}) ==
              verdicts_in_double(block_on_host(lane())));
}

TEST_P(TwinOfDoubles, HasItsOwnKernelsAndSites) {
  for (const Variant variant : {Variant::cuda_fma, Variant::cuda_nofma}) {
    const TwinRow& row = twin_row(sibling(variant));
    EXPECT_STRNE(row.doubles.hash, row.hash);
    EXPECT_STRNE(row.doubles.symbol, row.symbol);
    EXPECT_STRNE(row.doubles.trace_hash, row.trace_hash);
  }
  for (const ContractionSite& site : contraction_sites(lane(), double_sample()[0])) {
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(GRAZE_SOURCE_DIR) / site.at.file)) << site.at.file;
    EXPECT_GT(site.at.line, 0);
  }
}

// A lane's records for a block of pairs.
struct BlockRun {
  std::vector<double> values;
  std::vector<RecordedPath> paths;

  template <class Record>
  BlockRun(const Lane& lane, std::size_t pairs, const Record& record)
      : values(2 * questions_of(lane.algorithm).size() * pairs), paths(pairs) {
    record(Records{values.data(), pairs, paths.data()});
  }
  // The number of pairs for which the path or the bits of a value differ. All NaNs count as equal.
  std::size_t differences(const BlockRun& other) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      bool differs = paths[i].asked != other.paths[i].asked || paths[i].path != other.paths[i].path;
      for (std::size_t at = i; at < values.size(); at += paths.size())
        differs = differs || !same_bits(values[at], other.values[at]);
      count += differs;
    }
    return count;
  }
};

// Splits the sample into blocks. For each block, calls with_block(the block's pairs, the index of its first pair).
template <class WithBlock>
void for_each_block(const WithBlock& with_block) {
  const std::span<const DoublePair> pairs = double_sample();
  for (std::size_t first = 0; first < pairs.size(); first += 500) with_block(pairs.subspan(first, 500), first);
}

template <class Function>
BlockRun recorded(const Lane& lane, std::span<const DoublePair> pairs, const Function& function) {
  return {lane, pairs.size(), [&](const Records& to) { function(pairs.data(), pairs.size(), to); }};
}

TEST_P(TwinOfDoubles, RecordsWithoutContractionAreTheCpuLanes) {
  const Lane &cpu = sibling(Variant::cpu), &nofma = sibling(Variant::cuda_nofma);
  ASSERT_EQ(double_sample().size() % 500, 0u);
  std::size_t by_contraction = 0;
  for_each_block([&](std::span<const DoublePair> pairs, std::size_t first) {
    const BlockRun host = recorded(cpu, pairs, host_record_of_doubles(cpu));
    ASSERT_EQ(recorded(nofma, pairs, record_row(nofma).doubles.record).differences(host), 0u) << first;
    by_contraction += recorded(lane(), pairs, record_row(lane()).doubles.record).differences(host);
  });
  EXPECT_GT(by_contraction * 5, double_sample().size());
}

TEST_P(TwinOfDoubles, RecordedVerdictsAreTheVerdicts) {
  for (const Variant variant : {Variant::cuda_fma, Variant::cuda_nofma}) {
    const std::vector<Verdict> verdicts = verdicts_in_double(block_on_host(sibling(variant)));
    std::size_t differ = 0;
    for_each_block([&](std::span<const DoublePair> pairs, std::size_t first) {
      const BlockRun run = recorded(sibling(variant), pairs, record_row(sibling(variant)).doubles.record);
      for (std::size_t i = 0; i < pairs.size(); ++i)
        differ += recorded_verdict(run.paths[i].path) != verdicts[first + i];
    });
    EXPECT_EQ(differ, 0u) << name(variant);
  }
}

TEST_P(TwinOfDoubles, RecordsFusingAllSitesAreThoseOfCudaFmaAndNoneThoseOfCudaNofma) {
  const std::size_t sites = record_row(lane()).doubles.sites.size();
  ASSERT_GT(sites, 0u);
  const std::vector<std::uint64_t> none((sites + 63) / 64, 0), all(none.size(), ~std::uint64_t{0});
  for_each_block([&](std::span<const DoublePair> pairs, std::size_t first) {
    if (first % 5'000 != 0) return;  // take only one block of each stratum
    for (const auto& [variant, mask] : {std::pair(Variant::cuda_fma, all), {Variant::cuda_nofma, none}}) {
      const BlockRun run = recorded(sibling(variant), pairs, record_row(sibling(variant)).doubles.record);
      const BlockRun fusing(lane(), pairs.size(), [&, &of = mask](const Records& to) {
        record_row(lane()).doubles.record_fusing(pairs.data(), pairs.size(), to, of.data());
      });
      EXPECT_EQ(fusing.differences(run), 0u) << first;
    }
  });
  for (const ContractionSite& site : record_row(lane()).doubles.sites) {
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(GRAZE_SOURCE_DIR) / site.at.file)) << site.at.file;
    EXPECT_GT(site.at.line, 0);
  }
}

TEST_P(TwinOfDoubles, RecordsOfFloatsAreThoseOfTheTwinOfFloats) {
  std::vector<Pair> floats;
  std::vector<DoublePair> doubles;
  for (std::uint64_t i = 0; i < 10'000; ++i) {
    floats.push_back(strata::generate(7, strata::kStrata[i % strata::kStrataCount].stratum, i));
    doubles.push_back(in_doubles(floats.back()));
  }
  const BlockRun of_floats(lane(), floats.size(),
                           [&](const Records& to) { record_row(lane()).record(floats.data(), floats.size(), to); });
  EXPECT_EQ(recorded(lane(), doubles, record_row(lane()).doubles.record).differences(of_floats), 0u);
}

// The evidence comes from the record for double kernels, not from the one for float32.
TEST_P(TwinOfDoubles, EvidenceSaysWhatTheRecordSays) {
  const auto record =
      nlohmann::json::parse(std::ifstream(GRAZE_SOURCE_DIR "/cuda/proofs/nvidia_h200_nvcc_13.0.88_f64.json"));
  int told = 0;
  for (const Variant variant : {Variant::cuda_fma, Variant::cuda_nofma}) {
    const TwinRow& row = twin_row(sibling(variant));
    for (const auto& proven : record.at("lanes")) {
      if (proven.at("hash") != row.doubles.hash || proven.at("trace_hash") != row.doubles.trace_hash) continue;
      EXPECT_EQ(proven.at("lane"), sibling(variant).id);
      EXPECT_EQ(twin_evidence(sibling(variant), true),
                "twin, verified on NVIDIA H200, nvcc 13.0.88: GPU and twin agree on 1e+08 pairs, the GPU's default "
                "build and explicit PTX on 1e+09");
      EXPECT_NE(twin_evidence(sibling(variant), true), twin_evidence(sibling(variant)));
      ++told;
    }
  }
  EXPECT_EQ(told, 2);
}

TEST(TwinOfDoubles, LanesInFloatHaveNone) {
  EXPECT_EQ(twin_row(*find_lane("moller_1997/f32/cuda-fma")).doubles.decide, nullptr);
  EXPECT_FALSE(block_on_host(*find_lane("moller_1997/f32/cuda-fma")).decides_doubles());
  EXPECT_EQ(record_row(*find_lane("moller_1997/f32/cuda-fma")).doubles.record, nullptr);
  EXPECT_TRUE(record_row(*find_lane("moller_1997/f32/cuda-fma")).doubles.sites.empty());
  EXPECT_EQ(host_record_of_doubles(*find_lane("moller_1997/f32/cpu")), nullptr);
}

}  // namespace
}  // namespace graze::cuda
