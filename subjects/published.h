// SPDX-License-Identifier: Apache-2.0
// Provides the published algorithms as sources, so that toolchains can compile them wherever Graze runs.
#pragma once

#include <filesystem>
#include <vector>

#include "core/lanes/lanes.h"

namespace graze::subjects {

// The function's name in a source that published_source writes. This function is a template for float and double.
inline constexpr char kPublishedFunction[] = "graze_published";

// One lane of each published algorithm, in the order of the lane table.
std::vector<const Lane*> published_algorithms();

// Writes the source of the lane's algorithm into the cache, together with the headers that it includes, which are
// embedded in this program.   Returns: the source file.   Requires: a lane of a published algorithm.
// Throws: std::runtime_error; Stopped.
std::filesystem::path published_source(const Lane& lane);

}  // namespace graze::subjects
