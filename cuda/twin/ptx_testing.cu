// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/ptx_testing.h"

#include "cuda/lanes/device_memory.cuh"

namespace graze::cuda {

std::vector<std::uint64_t> run_ptx(const std::string& ptx, const std::string& kernel, const void* inputs,
                                   std::size_t count, std::size_t input_bytes, std::size_t slots) {
  cudaLibrary_t library;
  cudaKernel_t entry;
  check(cudaLibraryLoadData(&library, ptx.c_str(), nullptr, nullptr, 0, nullptr, nullptr, 0));
  check(cudaLibraryGetKernel(&entry, library, kernel.c_str()));
  DeviceArray<unsigned char> in;
  DeviceArray<std::uint64_t> out;
  unsigned char* const first_in = in.at_least(count * input_bytes);
  std::uint64_t* const first_out = out.at_least(count * slots);
  check(cudaMemcpy(first_in, inputs, count * input_bytes, cudaMemcpyHostToDevice));
  check(cudaMemset(first_out, 0, count * slots * sizeof(std::uint64_t)));
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned char* in_at = first_in + i * input_bytes;
    std::uint64_t* out_at = first_out + i * slots;
    void* arguments[] = {&in_at, &out_at};
    check(cudaLaunchKernel(reinterpret_cast<const void*>(entry), dim3(1), dim3(1), arguments, 0, nullptr));
  }
  std::vector<std::uint64_t> result(count * slots);
  check(cudaMemcpy(result.data(), first_out, result.size() * sizeof(std::uint64_t), cudaMemcpyDeviceToHost));
  check(cudaLibraryUnload(library));
  return result;
}

}  // namespace graze::cuda
