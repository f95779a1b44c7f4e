// SPDX-License-Identifier: Apache-2.0
// Compiles and runs the canaries (canaries.c).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "subjects/toolchains/claim.h"

namespace graze::subjects {

// Whether the command compiles C++, not C: its program's name contains "++".
bool is_cxx(std::string_view compiler);

// Compiles the canaries with the command and runs them.   run: as Toolchain::run.   Returns: the output of the
// canaries.   Throws: std::runtime_error with the compiler's first error, or when the program fails; Stopped.
std::string run_canaries(const std::string& compiler, const std::string& run);

// The documented_claim for code that the command compiles.   Throws: as run_canaries.
std::optional<Claim> claim_of(const std::string& compiler);

}  // namespace graze::subjects
