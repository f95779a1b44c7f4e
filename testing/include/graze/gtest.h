// SPDX-License-Identifier: Apache-2.0
// GRAZE_TEST(Name, function) and GRAZE_TEST(Name, function, .strata = "near_*", …) define the GoogleTest test
// Name.Overlap. The options are the members of graze::TestOptions, in the same order.
#pragma once

#include <graze/test.h>
#include <gtest/gtest.h>

#define GRAZE_TEST(name, function, ...)                                                                     \
  TEST(name, Overlap) {                                                                                     \
    const ::graze::TestResult result =                                                                      \
        ::graze::test_overlap(#function, ::graze::overlap_of(function), ::graze::TestOptions{__VA_ARGS__}); \
    RecordProperty("pairs", std::to_string(result.pairs));                                                  \
    RecordProperty("declined", std::to_string(result.counts.declined));                                     \
    RecordProperty("wrong", std::to_string(result.counts.wrong()));                                         \
    if (!result.passed) FAIL() << result.message;                                                           \
  }
