// SPDX-License-Identifier: Apache-2.0
// GRAZE_TEST for the frameworks that have TEST_CASE, INFO and REQUIRE. <graze/catch2.h> and <graze/doctest.h> include
// this file after their framework.
#pragma once

#include <graze/test.h>

#define GRAZE_TEST(name, function, ...)                                                                     \
  TEST_CASE(#name) {                                                                                        \
    const ::graze::TestResult result =                                                                      \
        ::graze::test_overlap(#function, ::graze::overlap_of(function), ::graze::TestOptions{__VA_ARGS__}); \
    INFO(result.message);                                                                                   \
    REQUIRE(result.passed);                                                                                 \
  }
