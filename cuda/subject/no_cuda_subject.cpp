// SPDX-License-Identifier: Apache-2.0
// Replaces cuda_subject.cpp and the files that it needs in builds by scripts/campaign. Every build links graze_campaign
// with this file. If a function of cuda_subject.h were missing here, the linker would add cuda_subject.cpp and then
// report all other functions as defined twice.
#include "core/error.h"
#include "cuda/subject/cuda_subject.h"

namespace graze::cuda {

std::string evidence(const CudaBuild&) { return "no twin: not in this build"; }

std::vector<CudaBuild> build_cuda_subject(const std::filesystem::path&, const std::string&,
                                          const std::vector<std::string>&, const std::filesystem::path&,
                                          std::optional<Variant>) {
  throw std::runtime_error(not_in_a_campaigns_build("a subject in CUDA"));
}

}  // namespace graze::cuda
