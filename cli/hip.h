// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace graze::cli {

// `graze toolchain hip`: lists the products that hipcc fuses for AMD's GPUs, and nvcc for NVIDIA's, in the subjects, or
// in the published algorithms. json: a file for them, or empty.   Returns: the exit status: 1 if products stay fused
// with -ffp-contract=off.
int list_hip_plans(const std::vector<std::string>& subjects, const std::vector<std::string>& flags,
                   const std::string& json);

}  // namespace graze::cli
