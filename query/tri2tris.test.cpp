// SPDX-License-Identifier: Apache-2.0
// Calls both 2012 functions as a program of that time did: special cases, random triangles and the four flags.
#include <detect-tri2tris-intersection.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <vector>

#include "query/testing.h"

namespace graze::query {
namespace {

constexpr triangle_t kReference = {{0, -2, 6}, {0, 5, 0}, {0, -3, 0}};
triangle_t special_cases[] = {
    // one for each position of the vertices relative to the line where the two planes meet; all meet the reference
    {{-2, -2, 0}, {2, -3, 0}, {3, -1, 0}},
    {{2, -1, 0}, {-2, -1.5f, 0}, {-3, 0, 0}},
    {{0, 0, 0}, {-2, 0.5f, 0}, {-3, 2, 0}},
    {{0, 0.5f, 0}, {2, 0, 0}, {3, 1, 0}},
    {{3, 1.5f, 0}, {0, 1, 0}, {0, 2, 0}},
    {{-2, 4.7f, 0}, {0, 3.7f, 0}, {2, 4.7f, 0}},
    {{1.5f, -3, 5.5f}, {-2, -2, 5.5f}, {1.5f, 0, 5.5f}},
    {{2, 0, 0.5f}, {-2, 0, 1.5f}, {1, 0, 4}},
    {{0, 3, 1}, {0, 1, 1.5f}, {0, 4, 3}},
    {{-3, 3, 0}, {0, 2.5f, 0}, {0, 3.5f, 0}},
};
constexpr int kCases = sizeof special_cases / sizeof special_cases[0];

// Random triangles, drawn as in the thesis's listing.
std::vector<triangle_t> random_triangles(int count) {
  std::srand(2012);
  std::vector<triangle_t> triangles(static_cast<std::size_t>(count));
  for (triangle_t& t : triangles) {
    float base[3];
    for (float& x : base) x = static_cast<float>(std::rand() % 80 - 40) / 10.0f;
    for (coord_t* p : {&t.p1, &t.p2, &t.p3})
      *p = {base[0] + static_cast<float>(std::rand() % 5), base[1] + static_cast<float>(std::rand() % 5),
            base[2] + static_cast<float>(std::rand() % 5)};
  }
  return triangles;
}

using Function = int8_t (*)(triangle_t, triangle_t[], int, uint8_t[]);

class Tri2Tris : public testing::TestWithParam<Function> {
 protected:
  void SetUp() override {
    if (GetParam() == tri2tris_intersection_detect_gpu && graze_devices() == 0) {
      uint8_t results[kCases];
      EXPECT_EQ(GetParam()(kReference, special_cases, kCases, results), -1);
      GTEST_SKIP() << "no device: the function returned -1";
    }
  }
  void TearDown() override { config_reset(); }
};

TEST_P(Tri2Tris, TheSpecialCasesIntersect) {
  for (triangle_t& t : special_cases) {
    uint8_t result = 9;
    EXPECT_EQ(GetParam()(kReference, &t, 1, &result), 1);
    EXPECT_EQ(result, 1);
  }
  config_set(COMPUTE_ALL_INTERSECTION);
  uint8_t results[kCases] = {};
  EXPECT_EQ(GetParam()(kReference, special_cases, kCases, results), 1);
  for (const uint8_t result : results) EXPECT_EQ(result, 1);
}

TEST_P(Tri2Tris, TheRandomTrianglesAreDecidedExactly) {
  std::vector<triangle_t> triangles = random_triangles(200'000);
  const triangle_t reference = {{2, -2, 4}, {1, 5, -2}, {1, -3, -3}};
  graze_triangles part = {};
  part.count = triangles.size();
  part.device = -1;
  part.rows = &triangles[0].p1.x;
  std::vector<std::uint8_t> expected;
  const Answer answer = Context().all(kThesisReference, part, expected);
  EXPECT_GT(answer.hits, 10'000u);
  for (const int flags : {0, NO_WDDM_TDR_WORKAROUND, FORCE_SINGLE_GPU_COMPUTATION}) {
    std::vector<std::uint8_t> results(triangles.size(), 9);
    config_set(static_cast<std::uint8_t>(COMPUTE_ALL_INTERSECTION | flags));
    EXPECT_EQ(GetParam()(reference, triangles.data(), 200'000, results.data()), 1);
    EXPECT_EQ(results, expected);
    config_reset();
    config_set(static_cast<std::uint8_t>(flags));
    EXPECT_EQ(GetParam()(reference, triangles.data(), 200'000, results.data()), 1);
    EXPECT_EQ(results[answer.first], 1);
    EXPECT_EQ(std::count(results.begin(), results.end(), 0), 199'999);
  }
}

TEST_P(Tri2Tris, FlagsAddUpUntilAReset) {
  triangle_t three[3] = {special_cases[0], {{9, 9, 9}, {9, 8, 9}, {9, 9, 8}}, special_cases[1]};
  std::vector<uint8_t> results(3);
  config_set(COMPUTE_ALL_INTERSECTION);
  config_set(VERBOSE_MODE);
  EXPECT_EQ(GetParam()(kReference, three, 3, results.data()), 1);
  EXPECT_EQ(results, (std::vector<uint8_t>{1, 0, 1}));
  config_reset();
  EXPECT_EQ(GetParam()(kReference, three, 3, results.data()), 1);
  EXPECT_EQ(results, (std::vector<uint8_t>{1, 0, 0}));
}

TEST_P(Tri2Tris, NoneAndErrors) {
  triangle_t far[2] = {{{9, 9, 9}, {9, 8, 9}, {9, 9, 8}}, {{9, 9, 9}, {9, 8, 9}, {9, 9, NAN}}};
  uint8_t results[2] = {9, 9};
  EXPECT_EQ(GetParam()(kReference, far, 1, results), 0);
  EXPECT_EQ(results[0], 0);
  EXPECT_EQ(GetParam()(kReference, far, 0, nullptr), 0);
  config_set(COMPUTE_ALL_INTERSECTION);
  EXPECT_EQ(GetParam()(kReference, far, 2, results), -1);
  EXPECT_EQ(results[1], 2);
  EXPECT_EQ(GetParam()(kReference, nullptr, 2, results), -1);
  EXPECT_EQ(GetParam()(kReference, far, 2, nullptr), -1);
  EXPECT_EQ(GetParam()(kReference, far, -1, results), -1);
  config_set(VERBOSE_MODE);
  testing::internal::CaptureStderr();
  EXPECT_EQ(GetParam()(kReference, far, -1, results), -1);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "tri2tris_intersection_detect: expected an array size of at least 0, found a negative size\n");
}

INSTANTIATE_TEST_SUITE_P(, Tri2Tris,
                         testing::Values(&tri2tris_intersection_detect_cpu, &tri2tris_intersection_detect_gpu),
                         [](const auto& of) { return of.index == 0 ? "Cpu" : "Gpu"; });

}  // namespace
}  // namespace graze::query
