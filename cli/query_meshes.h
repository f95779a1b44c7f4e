// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace graze::cli {

struct MeshQuestion {
  std::vector<std::string> files;  // one mesh against itself, or two against each other
  bool json;
  std::string executor;         // auto, one-core, all-cores, one-gpu, all-gpus
  std::string csv, obj, pairs;  // files, or empty
  bool exact_input;
};

// `graze query --self` and `--between`: prints how many pairs of triangles intersect, and how, and writes the pairs.
// Sets `status` if it was interrupted; then nothing is written.
void query_meshes(const MeshQuestion& question, int& status);

}  // namespace graze::cli
