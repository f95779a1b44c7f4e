// SPDX-License-Identifier: Apache-2.0
// GRAZE_TEST(Name, function, …), as <graze/gtest.h>, as a test case of Catch2, versions 2 and 3.
#pragma once

#if __has_include(<catch2/catch_test_macros.hpp>)
#include <catch2/catch_test_macros.hpp>
#else
#include <catch2/catch.hpp>
#endif

#include <graze/test_case.h>
