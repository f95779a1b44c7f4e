// SPDX-License-Identifier: Apache-2.0
// Replaces the device code in builds without nvcc. These builds use no device; they run CUDA lanes on their twins.
#include "cuda/lanes/device.h"

#include <stdexcept>

#include "cuda/engine/discrepancy.h"
#include "cuda/engine/engine.h"
#include "cuda/engine/sweep.h"
#include "cuda/lanes/device_costs.h"
#include "cuda/query/device_query.h"
#include "cuda/query/device_rows.h"
#include "cuda/subject/subject_device.h"
#include "cuda/twin/prove.h"

namespace graze::cuda {

std::unique_ptr<Device> open_device(std::string& why_not) {
  why_not = "built without CUDA";
  return nullptr;
}

std::vector<std::unique_ptr<DeviceEngine>> open_engines(std::span<const Lane* const>) { return {}; }

std::vector<ErrorCounts> count_errors(const Lane&, std::span<const Lane>, const strata::PairSource&) {
  throw std::runtime_error("cannot sweep on a device: built without CUDA");
}

bool records_on_device(const Lane&) { return false; }

void count_discrepancies(const Lane&, const Lane&, const strata::PairSource&, const DiscrepancySums&) {
  throw std::runtime_error("cannot compare values on a device: built without CUDA");
}

std::uint64_t count_different_runs(const Lane&, const Lane&, const strata::PairSource&) {
  throw std::runtime_error("cannot compare values on a device: built without CUDA");
}

DeviceCosts measure_on_device(std::span<const Lane* const>, const strata::PairBlock&, int) {
  throw std::runtime_error("cannot measure costs on a device: built without CUDA");
}

ProofRecord prove_twin(const ProofOptions&) { throw std::runtime_error("a proof needs a device: built without CUDA"); }

std::unique_ptr<SubjectOnDevice> open_on_device(const CudaBuild&) {
  throw std::runtime_error("cannot run your CUDA code on a device: built without CUDA");
}

ProofRecord prove_subjects(std::span<const NamedBuild>, const ProofOptions&) {
  throw std::runtime_error("a proof needs a device: built without CUDA");
}

int count_query_devices(std::string& why_not) {
  why_not = "built without CUDA";
  return 0;
}

std::unique_ptr<QueryDevice> open_query_device(int) {
  throw DeviceFailure("cannot query on a device: built without CUDA", false);
}

std::unique_ptr<DeviceMemory> device_memory(int, std::size_t) {
  throw DeviceFailure("cannot allocate memory on a device: built without CUDA", false);
}

DeviceSpeeds measure_speeds(int, std::size_t) {
  throw DeviceFailure("cannot measure the speeds of a device: built without CUDA", false);
}

KernelNeeds needs_of_exact_query(int) {
  throw DeviceFailure("cannot read a kernel's resources from a device: built without CUDA", false);
}

}  // namespace graze::cuda
