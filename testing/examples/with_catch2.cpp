// SPDX-License-Identifier: Apache-2.0
#define CATCH_CONFIG_MAIN
#include <graze/catch2.h>

#include "overlap.h"

GRAZE_TEST(Overlap, overlap)
GRAZE_TEST(OverlapOnUniform, overlap, .strata = "uniform,thesis")
