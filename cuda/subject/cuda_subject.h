// SPDX-License-Identifier: Apache-2.0
// A user's CUDA source as a subject. It has a function `__device__ bool f(const float a[9], const float b[9])`, which
// may also return int or take double. NVRTC compiles the source in every device variant; a twin replays it where
// possible.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"
#include "core/variants.h"

namespace graze::cuda {

// The name of the kernel that is appended to the source. Its parameters are (const T* coordinates, unsigned stride,
// unsigned count, signed char* answers). `coordinates` has 18 arrays; answers are -1 declined, 0 disjoint, 1
// intersects.
inline constexpr char kSubjectKernel[] = "graze_subject_kernel";

struct CudaBuild {
  Variant variant;
  Scalar scalar;
  std::string ptx;                      // for compute_75, as NVRTC writes it
  std::string toolkit;                  // "13.0.88"
  std::string hash;                     // of the instructions and their contractions; a proof is valid for this hash
  std::filesystem::path twin;           // a shared library, see cuda/twin/twin_library.h; empty without a twin
  std::string why_no_twin;              // one line; empty if there is a twin
  bool machine_code_identical = false;  // ptxas assembles this PTX to the same bytes as the PTX with every contraction
                                        // written out, which the twin replays
};

// "twin, machine code identical", "twin, not yet verified", or "no twin: …".
std::string evidence(const CudaBuild& build);

// The builds, in the order of the variants: cuda-nofma, cuda-fma, cuda-fast, cuda-ftz; or `only` one of them. `flags`
// are passed to NVRTC unchanged. The folder `cache` keeps twins and results of ptxas by hash; incomplete files in it
// are never used. Throws: UsageError, one line with the user's file and line, when the source cannot be read, does not
// compile, or has no such function. Throws: std::runtime_error without NVRTC.
std::vector<CudaBuild> build_cuda_subject(const std::filesystem::path& source, const std::string& function,
                                          const std::vector<std::string>& flags, const std::filesystem::path& cache,
                                          std::optional<Variant> only = std::nullopt);

}  // namespace graze::cuda
