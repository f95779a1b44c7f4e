// SPDX-License-Identifier: Apache-2.0
#include <graze/gtest.h>

static bool overlap(const float a[9], const float b[9]) { return a[0] < b[0]; }

GRAZE_TEST(Overlap, overlap)
