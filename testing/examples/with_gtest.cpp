// SPDX-License-Identifier: Apache-2.0
#include <graze/gtest.h>

#include "overlap.h"

GRAZE_TEST(Overlap, overlap)  // all strata: fails, because products of doubles round
GRAZE_TEST(OverlapOnUniform, overlap, .strata = "uniform,thesis")
GRAZE_TEST(OverlapLoose, overlap, .strata = "near_*", .pairs = 20'000, .max_wrong = 0.05, .touching = graze::either)
