// SPDX-License-Identifier: Apache-2.0
// GRAZE_TEST(Name, function, …) as in <graze/gtest.h>, but as a test case of Catch2, version 2 or 3.
#pragma once

#if __has_include(<catch2/catch_test_macros.hpp>)
#include <catch2/catch_test_macros.hpp>
#else
#include <catch2/catch.hpp>
#endif

#include <graze/test_case.h>
