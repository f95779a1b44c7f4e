// SPDX-License-Identifier: Apache-2.0
// Stores the builds of cuda/subject/styles in a folder: PTX, twin and a line about both. With these files, tests run on
// a machine that has a device but neither NVRTC nor a compiler.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cuda/subject/cuda_subject.h"

namespace graze::cuda {

struct StyleBuild {
  std::string name;  // "reciprocal/f32/cuda-fma"
  CudaBuild build;
};

// Builds every style, and writes the builds with a twin to the folder.
void write_styles(const std::filesystem::path& styles, const std::filesystem::path& folder);

// Reads the builds that write_styles wrote; empty if the folder has none.
std::vector<StyleBuild> read_styles(const std::filesystem::path& folder);

}  // namespace graze::cuda
