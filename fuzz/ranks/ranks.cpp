// SPDX-License-Identifier: Apache-2.0
#include "fuzz/ranks/ranks.h"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/cannot.h"

namespace graze::fuzz {

bool started_by_mpirun() {
  const auto several = [](const char* name) {
    const char* size = std::getenv(name);
    return size && std::atoi(size) > 1;
  };
  return several("OMPI_COMM_WORLD_SIZE") || several("PMI_SIZE") ||
         (std::getenv("PMIX_RANK") && several("SLURM_NTASKS"));
}

std::unique_ptr<Ranks> open_ranks() {
  const std::filesystem::path library =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "libgraze_mpi.so";
  if (!std::filesystem::exists(library))
    throw std::runtime_error(
        cannot("run under mpirun without", library, "this build found no MPI; install MPI and build again"));
  void* handle = dlopen(library.c_str(), RTLD_NOW | RTLD_GLOBAL);  // Open MPI's plugins need its symbols globally
  if (!handle) throw std::runtime_error(cannot("load", library, dlerror()));
  const auto open = reinterpret_cast<Ranks* (*)()>(dlsym(handle, "graze_open_ranks"));
  if (!open) throw std::runtime_error(cannot("load", library, "it belongs to another build"));
  return std::unique_ptr<Ranks>(open());
}

void take_one_device(int local_rank) {
  std::vector<std::string> devices;
  if (const char* visible = std::getenv("CUDA_VISIBLE_DEVICES")) {
    std::istringstream list(visible);
    for (std::string one; std::getline(list, one, ',');) devices.push_back(one);
  } else {
    while (std::filesystem::exists("/dev/nvidia" + std::to_string(devices.size())))
      devices.push_back(std::to_string(devices.size()));
  }
  if (devices.empty()) return;
  setenv("CUDA_VISIBLE_DEVICES", devices[static_cast<std::size_t>(local_rank) % devices.size()].c_str(), 1);
}

}  // namespace graze::fuzz
