// SPDX-License-Identifier: Apache-2.0
// The builds of cuda/subject/styles in a folder, for tests on a machine that has a device, but neither NVRTC nor a
// compiler: of each one the PTX, the twin, and a line about both.
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

// Builds every style; writes all builds that have a twin.
void write_styles(const std::filesystem::path& styles, const std::filesystem::path& folder);

// Those builds; empty when the folder has none.
std::vector<StyleBuild> read_styles(const std::filesystem::path& folder);

}  // namespace graze::cuda
