// SPDX-License-Identifier: Apache-2.0
#include "cuda/subject/machine_code.h"

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "core/plain_file.h"
#include "core/programs/run_program.h"

namespace graze::cuda {
namespace {

namespace fs = std::filesystem;

template <class T>
T read(const std::string& file, std::size_t at) {
  T value;
  if (at + sizeof value > file.size()) throw std::runtime_error("the cubin is truncated");
  std::memcpy(&value, file.data() + at, sizeof value);
  return value;
}

}  // namespace

std::map<std::string, std::string> read_cubin(const fs::path& path) {
  std::string why;
  const std::string file = plain_file(path, why).value_or("");
  const auto sections = read<std::uint64_t>(file, 0x28);
  const auto size = read<std::uint16_t>(file, 0x3a), count = read<std::uint16_t>(file, 0x3c),
             names = read<std::uint16_t>(file, 0x3e);
  const auto names_at = read<std::uint64_t>(file, sections + std::uint64_t{names} * size + 0x18);
  std::map<std::string, std::string> code;
  for (std::uint64_t s = sections; s < sections + std::uint64_t{count} * size; s += size) {
    const std::string section = file.c_str() + names_at + read<std::uint32_t>(file, s);
    if (section.starts_with(".text."))
      code[section.substr(6)] = file.substr(read<std::uint64_t>(file, s + 0x18), read<std::uint64_t>(file, s + 0x20));
  }
  return code;
}

fs::path find_ptxas(const fs::path& library) {
  std::vector<fs::path> folders;
  for (const char* variable : {"CUDA_HOME", "CUDA_PATH"}) {
    if (const char* home = std::getenv(variable)) folders.push_back(fs::path(home) / "bin");
  }
  std::error_code none;
  folders.push_back(fs::weakly_canonical(library, none).parent_path() / "../bin");
  // The library may be in …/targets/x86_64-linux/lib.
  folders.push_back(fs::weakly_canonical(library, none).parent_path() / "../../../bin");
  std::istringstream path(std::getenv("PATH") ? std::getenv("PATH") : "");
  for (std::string folder; std::getline(path, folder, ':');) folders.push_back(folder);
  folders.push_back("/usr/local/cuda/bin");
  for (const fs::path& folder : folders) {
    if (!folder.empty() && access((folder / "ptxas").c_str(), X_OK) == 0) return folder / "ptxas";
  }
  return {};
}

std::map<std::string, std::string> assemble(const fs::path& ptxas, const std::string& ptx, const fs::path& scratch) {
  const fs::path in = scratch / "code.ptx", out = scratch / "code.cubin";
  std::ofstream(in, std::ios::binary) << ptx;
  std::string said;
  if (run_program({{ptxas.string(), "-arch=sm_90", in.string(), "-o", out.string()}}, scratch, said) != 0)
    throw std::runtime_error("ptxas: " + said.substr(0, said.find('\n')));
  return read_cubin(out);
}

}  // namespace graze::cuda
