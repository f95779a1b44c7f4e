// SPDX-License-Identifier: Apache-2.0
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <graze/doctest.h>

#include "overlap.h"

GRAZE_TEST(Overlap, overlap)
GRAZE_TEST(OverlapOnUniform, overlap, .strata = "uniform,thesis")
