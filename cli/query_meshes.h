// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/commands.h"

namespace graze::cli {

struct QueryOptions {
  std::vector<std::string> files;
  std::string self;
  bool between = false, any = false, all = false, json = false, exact_input = false;
  LaneOptions lanes;
  std::vector<std::string> executors = {"auto"};  // or one-core, all-cores, one-gpu, all-gpus
  std::string csv, obj, pairs, mismatches;        // files, or empty
};

// `graze query --self` and `--between`: prints how many pairs of triangles intersect, and how, and writes the pairs.
// If the search is interrupted, sets `status` and writes nothing.
void query_meshes(const QueryOptions& options, int& status);

}  // namespace graze::cli
