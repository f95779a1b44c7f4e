// SPDX-License-Identifier: Apache-2.0
// GRAZE_TEST(Name, function, …) as in <graze/gtest.h>, but as a test case of doctest.
#pragma once

#include <doctest/doctest.h>
#include <graze/test_case.h>
