// SPDX-License-Identifier: Apache-2.0
// A user's CUDA source as a subject: `__device__ bool f(const float a[9], const float b[9])`, or int, or in double,
// with whatever else the file holds. Compiled by NVRTC in every device variant, and replayed by a twin where it can be.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"
#include "core/variants.h"

namespace graze::cuda {

// The name of the kernel that is added to the source: (const T* coordinates, unsigned stride, unsigned count, signed
// char* answers) of a block of 18 coordinate arrays; -1 declined, 0 disjoint, 1 intersects.
inline constexpr char kSubjectKernel[] = "graze_subject_kernel";

struct CudaBuild {
  Variant variant;
  Scalar scalar;
  std::string ptx;                      // for compute_75, as NVRTC gives it
  std::string toolkit;                  // "13.0.88"
  std::string hash;                     // of the instructions and their contractions: what a proof holds for
  std::filesystem::path twin;           // a shared library, see cuda/twin/twin_library.h; empty where there is none
  std::string why_no_twin;              // one line; empty where there is one
  bool machine_code_identical = false;  // ptxas gives the same bytes for this PTX and for that with every contraction
                                        // written out, which the twin replays
};

// "twin, machine code identical", "twin, not yet verified", or "no twin: …".
std::string evidence(const CudaBuild& build);

// The builds, in the order of the variants: cuda-nofma, cuda-fma, cuda-fast, cuda-ftz. `flags` go to NVRTC as they are.
// Twins and what ptxas says are kept in `cache`, a folder, by hashes; nothing half-written is ever used.
// Throws: UsageError in one line with the user's file and line when the source cannot be read or does not compile, or
// has no such function; std::runtime_error without NVRTC.
std::vector<CudaBuild> build_cuda_subject(const std::filesystem::path& source, const std::string& function,
                                          const std::vector<std::string>& flags, const std::filesystem::path& cache);

}  // namespace graze::cuda
