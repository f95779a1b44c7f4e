// SPDX-License-Identifier: Apache-2.0
// Properties of standard output and standard error as screens.
#pragma once

#include "reports/screen.h"

namespace graze::cli {

// A terminal has the columns that it reports, or else COLUMNS. It has colour unless NO_COLOR is set or TERM is dumb.
// Files and pipes have 80 columns and no colour.
reports::Screen output_screen();
reports::Screen error_screen();

}  // namespace graze::cli
