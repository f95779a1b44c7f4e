// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace graze::cli {

// Unpacks the file into the new folder NAME-unpacked, runs its campaign there, and compares the results with the
// pack's. Defined in pack.cpp.   Returns: the exit status, 1 if something differs.
int repro_pack(const std::string& file);

}  // namespace graze::cli
