// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace graze::cli {

struct SelfOptions {
  std::string mesh;
  bool json;
  std::string obj, pairs;  // files, or empty
};

// `graze query --self`: prints how many pairs of a mesh's triangles share more than their common vertices and edges,
// and writes those pairs.
void query_self(const SelfOptions& options);

}  // namespace graze::cli
