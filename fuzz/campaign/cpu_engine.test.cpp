// SPDX-License-Identifier: Apache-2.0
// A campaign gives the same bytes whether the exact lane or the oracle judges it. The oracle detects a wrong exact
// lane.
#include "fuzz/campaign/cpu_engine.h"

#include "fuzz/campaign/campaign_testing.h"
#include "fuzz/campaign/signature_counts.h"
#include "oracle/truth.h"
#include "strata/strata.h"

namespace graze::fuzz {
namespace {

const DecideBlock& exact_lane() { return find_lane("exact/f32/cpu")->decide; }

class ExactJudge : public CampaignFiles {
 protected:
  Campaign campaign(const std::string& name, std::uint64_t pairs, std::uint64_t seed,
                    const std::vector<std::string>& strata = {}) const {
    return campaign_of(lanes_, strata::stratum_sources(seed, pairs, strata), seed, name);
  }

  std::uint64_t seen(const std::string& name, const char* by) const {
    return Json::parse(read_whole(root_ / name / "timings.json"))["oracle"][by];
  }

  SelectedLanes lanes_ = select_lanes({"*/cpu", "*/cpu-fma", "moller_1997/*/cuda-*"}, Executor::twin);
};

TEST_F(ExactJudge, LeavesTheBytesOfTheOracleOverAllStrata) {
  for (const std::uint64_t seed : {1, 77}) {
    const std::string oracle = "oracle" + std::to_string(seed), exact = "exact" + std::to_string(seed);
    run(campaign(oracle, 40'007, seed));
    Campaign c = campaign(exact, 40'007, seed);
    c.exact = exact_lane();
    const Json summary = run(c);
    EXPECT_GT(summary["signatures"].size(), 500u);
    expect_same_bytes(oracle, exact);
    EXPECT_EQ(seen(oracle, "cgal"), 40'007u);
    EXPECT_EQ(seen(oracle, "exact"), 0u);
    EXPECT_EQ(seen(exact, "exact"), 40'007u);
    // CGAL decides three sampled pairs of each stratum; the other pairs that it decides are kept cases.
    EXPECT_GE(seen(exact, "cgal"), summary["signatures"].size() / 4 + 3u * strata::kStrataCount);
    EXPECT_LT(seen(exact, "cgal"), 40'007u);
    EXPECT_GE(seen(exact, "gmp"), seen(exact, "cgal"));
  }
}

TEST_F(ExactJudge, InterruptionsAndScenesChangeNothing) {
  for (const bool exact : {false, true}) {
    Campaign c = campaign_of(lanes_, sources_in_scenes(4, 12'000), 4, exact ? "exact" : "oracle");
    if (exact) c.exact = exact_lane();
    exact ? void(run_in_parts(c)) : void(run(c));
  }
  expect_same_bytes("oracle", "exact");
}

// Decides exactly, but inverts the verdict if the hash of the first coordinate's bits is a multiple of `kEvery`.
template <unsigned kEvery>
void sometimes_wrong(const Pair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  exact_lane()(pairs, count, intersects, declined);
  for (std::size_t i = 0; i < count; ++i) {
    const auto bits = std::bit_cast<std::uint32_t>(pairs[i].a[0].x);
    intersects[i / 64] ^= std::uint64_t{bits * 2654435769u >> 8 < (1u << 24) / kEvery} << (i % 64);
  }
}

TEST_F(ExactJudge, TheOracleFindsAnExactLaneThatIsNotRight) {
  Campaign c = campaign("wrong", 20'000, 3, {"uniform"});
  c.exact = &sometimes_wrong<5000>;
  EXPECT_THROW(run(c), oracle::OracleMismatch);
}

// The only lane is wrong in the same way as the judge, so only the sample shows the error.
TEST_F(ExactJudge, TheSampleFindsWhatNoLaneShows) {
  lanes_ = select_lanes({"exact/f32/cpu"}, Executor::twin);
  lanes_.on_host[0] = &sometimes_wrong<20>;
  Campaign c = campaign("sample", 200'000, 3, {"uniform"});
  c.exact = &sometimes_wrong<20>;
  EXPECT_THROW(run(c), oracle::OracleMismatch);
  c = campaign("right", 20'000, 3, {"uniform"});
  c.exact = &sometimes_wrong<1u << 25>;  // this lane is never wrong
  lanes_.on_host[0] = exact_lane();
  EXPECT_NO_THROW(run(c));
}

TEST(SignatureCounts, AreThoseOfEachFailureAlone) {
  const SelectedLanes lanes = select_lanes({"moller_1997/*/cpu", "guigue*/f32/cpu", "exact/f32/cpu"}, Executor::twin);
  ASSERT_EQ(lanes.lanes.size(), 4u);
  constexpr Verdict yes = Verdict::intersects, no = Verdict::disjoint;
  SignatureCounts counts(lanes.lanes);
  std::map<analysis::Signature, SignatureCount> found;
  for (const std::uint64_t index : {9, 3, 5}) {
    const Verdict f64 = index == 5 ? no : index == 9 ? Verdict::declined : yes;
    const Verdict verdicts[] = {yes, f64, Verdict::declined, no};  // a subject that only declines does not fail
    counts.add(Relation{no, Contact::none, 1, {2, 1, true}}, Nesting::none, 7, verdicts, {index, 2});
    if (index == 3) counts.move_to(found);
  }
  counts.move_to(found);
  std::map<std::string, std::uint64_t> by_key;
  for (const auto& [signature, count] : found) by_key[analysis::key(signature)] = count.count;
  const std::string head = "none/21/coplanar/" + name_of_bucket(7);
  EXPECT_EQ(by_key, (std::map<std::string, std::uint64_t>{{head + "/moller_1997:+f32/cpu;+f64/cpu", 1},
                                                          {head + "/moller_1997:+f32/cpu;?f64/cpu", 1},
                                                          {head + "/moller_1997:+f32/cpu", 1}}));
  EXPECT_EQ(found.begin()->second.cases.front().source, 2);
}

}  // namespace
}  // namespace graze::fuzz
