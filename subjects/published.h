// SPDX-License-Identifier: Apache-2.0
// The published algorithms as sources, so that toolchains can compile them wherever Graze runs.
#pragma once

#include <filesystem>
#include <vector>

#include "core/lanes/lanes.h"

namespace graze::subjects {

// The name of the function in a source that published_source writes. The function is a template for float and double.
inline constexpr char kPublishedFunction[] = "graze_published";

// One lane of each published algorithm, in the order of the lane table.
std::vector<const Lane*> published_algorithms();

// Writes the source of the lane's algorithm into the cache, with the headers that it includes. This program contains
// these headers.   Returns: the source file.   Requires: a lane of a published algorithm.
// Throws: std::runtime_error; Stopped.
std::filesystem::path published_source(const Lane& lane);

}  // namespace graze::subjects
