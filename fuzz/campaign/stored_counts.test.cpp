// SPDX-License-Identifier: Apache-2.0
// Stored counts that contradict each other are rejected as damaged. Each count is tested at its limit.
#include "fuzz/campaign/stored_counts.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/message_testing.h"

namespace graze::fuzz {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kKey = "none/22/skew/+2^3/moller_1997:+f32/cpu";
const PairRange kRange{1, 100, 10};

// Ten pairs: six are in bucket 5, and two of these six intersect. Lane 0 is wrong on three pairs; lane 1, which is
// foreign code, is wrong on two pairs.
Json good() {
  return {{{-4, 4, 1, Json::array()}, {5, 6, 2, {{0, 2, 1, 0, 3}, {1, 0, 0, 0, 0, 1, 0, 1, 1}}}},
          Json::array(),
          {{kKey, 3, {101, 105, 109}}},
          {{"moller_1997/f32/cuda-fma", 1, {100}}},
          5,
          10,
          5,
          0,
          {9, {~std::uint64_t{0}, 8}}};
}

// The error on reading; empty if all counts agree.
std::string complaint(const Json& counts, Axis axis = Axis::none) {
  std::string bytes;
  Json::to_cbor(counts, bytes);
  return error_of<Damaged>([&] { from_bytes(bytes, kRange, axis, 2); });
}

TEST(StoredCounts, AreReadBack) {
  ASSERT_EQ(complaint(good()), "");
  std::string bytes;
  Json::to_cbor(good(), bytes);
  const StoredCounts counts = from_bytes(bytes, kRange, Axis::none, 2);
  EXPECT_EQ(to_bytes(counts), bytes);
  EXPECT_EQ(counts.tally.lane(0, 5).false_positive, 2u);
  EXPECT_EQ(counts.tally.lane(1, 5).crashed, 1u);
  EXPECT_EQ(counts.tally.lane(1, 5).by_convention, 1u);
  EXPECT_EQ(counts.signatures.at(kKey).cases.at(1), (CaseKey{105, 1}));
}

TEST(StoredCounts, ThatDoNotAgreeAreDamage) {
  const std::string margins = "the margins are inconsistent",
                    all = "the margins and the batch's pairs are inconsistent",
                    signatures = "the signatures and the batch's pairs are inconsistent",
                    digests = "the digests and the batch's pairs are inconsistent";
  struct Edit {
    const char* place;
    Json value;
    std::string said;
  };
  for (const auto& [place, value, said] : {
           Edit{"/0/0/0", 5, margins},  // a bucket occurs twice
           {"/0/1/0", -5, margins},     // the buckets are out of order
           {"/0/1/0", kBucketMost, ""},
           {"/0/1/0", kBucketMost + 1, margins},
           {"/0/0/0", -kBucketMost, ""},
           {"/0/0/0", -kBucketMost - 1, margins},
           {"/0/1/1", 5, all},          // the tally has fewer pairs than the range
           {"/0/1/1", 7, margins},      // the tally has more pairs than the range
           {"/0/1/2", 7, margins},      // more pairs that intersect than pairs
           {"/0/1/3/0/0", 1, margins},  // a lane occurs twice
           {"/0/1/3/1/0", 2, margins},  // there is no such lane
           {"/0/1/3/0/1", 4, ""},       // all disjoint pairs
           {"/0/1/3/0/1", 5, margins},
           {"/0/1/3/0/2", 2, ""},  // all pairs that intersect
           {"/0/1/3/0/2", 3, margins},
           {"/0/1/3/0/3", 3, ""},  // wrong on all six
           {"/0/1/3/0/3", 4, margins},
           {"/0/1/3/0/4", 7, margins},
           {"/0/1/3/0", Json{0, 2, 1, 0, 3, 0}, margins},
           {"/0/1/3/0", Json{0, 2, 1, 0, 3, 0, 0, 0, 0}, margins},  // foreign counts that are all 0
           {"/0/1/3/1/8", 4, ""},                                   // by convention on all but two pairs
           {"/0/1/3/1/8", 5, margins},
           {"/1", Json{{0, 10, 0, Json::array()}}, "the extremes and the batch's pairs are inconsistent"},
           {"/2/0/0", "none/22", signatures},
           {"/2/0/0", "none/22/skew/+2^3/moller 1997:+f32/cpu", signatures},
           {"/2/0/1", 10, ""},
           {"/2/0/1", 11, signatures},
           {"/2/0/1", 2, signatures},  // fewer than the kept cases
           {"/2/0/2", Json::array(), signatures},
           {"/2/0/2", Json{101, 101}, signatures},
           {"/2/0/2", Json{99}, signatures},
           {"/2/0/2", Json{110}, signatures},
           {"/2/0/2", Json{100, 101, 102, 103, 104}, signatures},
           {"/2/1", Json{kKey, 1, {102}}, signatures},  // the same key occurs again
           {"/3/0/0", "moller_1997", signatures},
           {"/4", 10, ""},
           {"/4", 11, "the disagreements and the batch's pairs are inconsistent"},
           {"/5", -1, "the pairs that CGAL decided are inconsistent"},
           {"/6", "5", "the pairs that GMP confirmed are inconsistent"},
           {"/7", 11, "the exact lane's pairs and the batch's pairs are inconsistent"},
           {"/8/0", 10, ""},
           {"/8/0", 11, digests},
           {"/8/1", Json{1}, digests},  // fewer digests than lanes
           {"/8/1/1", -1, digests},
           {"/8", 0, digests},
           {"/9", 0, "a batch's parts are inconsistent"},
       }) {
    Json edited = good();
    edited[Json::json_pointer(place)] = value;
    EXPECT_EQ(complaint(edited), said) << place << " " << value;
  }
  EXPECT_EQ(complaint(good(), Axis::scale), "the extremes and the batch's pairs are inconsistent");
}

}  // namespace
}  // namespace graze::fuzz
