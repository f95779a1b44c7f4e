// SPDX-License-Identifier: Apache-2.0
// A user's CUDA source as a subject. It must have a function `__device__ bool f(const float a[9], const float b[9])`,
// which may also return int or take double. NVRTC compiles the source in every device variant. If possible, a twin
// replays each build.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"
#include "core/variants.h"

namespace graze::cuda {

// The kernel that is appended to the source. Its parameters are (const T* coordinates, unsigned stride, unsigned count,
// signed char* answers). `coordinates` has 18 arrays. An answer is -1 for declined, 0 for disjoint, 1 for intersects.
inline constexpr char kSubjectKernel[] = "graze_subject_kernel";

struct CudaBuild {
  Variant variant;
  Scalar scalar;
  std::string ptx;                      // NVRTC's output for compute_75
  std::string toolkit;                  // "13.0.88"
  std::string hash;                     // hash of instructions and contractions, for which a proof is valid
  std::filesystem::path twin;           // a shared library, see cuda/twin/twin_library.h; empty without a twin
  std::string why_no_twin;              // one line; empty if there is a twin
  bool machine_code_identical = false;  // ptxas makes the same bytes from this PTX as from the PTX with every
                                        // contraction written out, which the twin replays
};

// "twin, machine code identical", "twin, not yet verified", or "no twin: …".
std::string evidence(const CudaBuild& build);

// Builds the source in the variants cuda-nofma, cuda-fma, cuda-fast and cuda-ftz, in this order, or only in the variant
// `only`. `flags` are passed to NVRTC unchanged. The folder `cache` keeps twins and ptxas results by hash; incomplete
// files in it are never used. Throws: UsageError, one line with the user's file and line, when the source cannot be
// read, does not compile, or has no such function. Also throws std::runtime_error without NVRTC.
std::vector<CudaBuild> build_cuda_subject(const std::filesystem::path& source, const std::string& function,
                                          const std::vector<std::string>& flags, const std::filesystem::path& cache,
                                          std::optional<Variant> only = std::nullopt);

}  // namespace graze::cuda
