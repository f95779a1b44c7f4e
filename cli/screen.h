// SPDX-License-Identifier: Apache-2.0
// What standard output and standard error are printed on.
#pragma once

#include "reports/screen.h"

namespace graze::cli {

// A terminal has the columns that it or else COLUMNS says, and colour unless NO_COLOR is set or TERM is
// dumb. Files and pipes have 80 and none.
reports::Screen output_screen();
reports::Screen error_screen();

}  // namespace graze::cli
