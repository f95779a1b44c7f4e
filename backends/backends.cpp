// SPDX-License-Identifier: Apache-2.0
#include "backends/backends.h"

#include "core/error.h"
#include "cuda/twin/twin.h"

namespace graze::backends {
namespace {

DecideBlock own_code(const Lane& lane) { return lane.decide; }

std::string why_not_on_processor(const Lane& lane, const std::string&) {
  return runs_on_this_cpu(lane) ? "" : "no " + std::string(info_of(lane.variant).needs) + " instructions";
}

// Foreign code and the programs of toolchains run in a separate process. In that process, foreign CUDA code runs
// on the device or as a twin, so it requires no instructions of this processor.
std::string why_not_in_process(const Lane& lane, const std::string& why_no_device) {
  if (!lane.decide) return lane.evidence;
  return lane.is_cuda() ? "" : why_not_on_processor(lane, why_no_device);
}

std::string why_no_twin(const Lane& lane, const std::string& why_no_device) {
  if (cuda::block_on_host(lane)) return "";
  if (lane.under && !cuda::has_policy_twins()) return not_in_a_campaigns_build("twins of lanes under tolerances");
  return why_no_device.empty() ? "no twin" : why_no_device + ", and no twin";
}

constexpr Backend kProcessor{
    "exact/f32/cpu", false, false, own_code, why_not_on_processor, [](const Lane&, bool) { return std::string(); }};
constexpr Backend kProcess{
    "exact/f32/cpu", false, false, own_code, why_not_in_process, [](const Lane& lane, bool) { return lane.evidence; }};
constexpr Backend kCuda{
    "exact/f32/cuda", true, true, cuda::block_on_host, why_no_twin, [](const Lane& lane, bool of_doubles) {
      return lane.exact ? std::string("twin, exact") : cuda::twin_evidence(lane, of_doubles);
    }};

}  // namespace

const Backend& backend_of(const Lane& lane) { return lane.foreign ? kProcess : lane.is_cuda() ? kCuda : kProcessor; }

Language language_of(const Lane& lane) { return lane.is_cuda() ? Language::cuda : Language::cpp; }

}  // namespace graze::backends
