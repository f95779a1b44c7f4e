// SPDX-License-Identifier: Apache-2.0
#include "cuda/subject/machine_code.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

extern char** environ;

namespace graze::cuda {
namespace {

namespace fs = std::filesystem;

template <class T>
T read(const std::string& file, std::size_t at) {
  T value;
  if (at + sizeof value > file.size()) throw std::runtime_error("a cubin that ends early");
  std::memcpy(&value, file.data() + at, sizeof value);
  return value;
}

std::string content(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

std::map<std::string, std::string> read_cubin(const fs::path& path) {
  const std::string file = content(path);
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
  // …/targets/x86_64-linux/lib
  folders.push_back(fs::weakly_canonical(library, none).parent_path() / "../../../bin");
  std::istringstream path(std::getenv("PATH") ? std::getenv("PATH") : "");
  for (std::string folder; std::getline(path, folder, ':');) folders.push_back(folder);
  folders.push_back("/usr/local/cuda/bin");
  for (const fs::path& folder : folders) {
    if (!folder.empty() && access((folder / "ptxas").c_str(), X_OK) == 0) return folder / "ptxas";
  }
  return {};
}

int run_program(const std::vector<std::string>& words, const fs::path& scratch, std::string& output) {
  const fs::path log = scratch / "output.txt";
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
  pid_t child = 0;
  const int failure = posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) {
    output = std::strerror(failure);
    return -1;
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  output = content(log);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::map<std::string, std::string> assemble(const fs::path& ptxas, const std::string& ptx, const fs::path& scratch) {
  const fs::path in = scratch / "code.ptx", out = scratch / "code.cubin";
  std::ofstream(in, std::ios::binary) << ptx;
  std::string said;
  if (run_program({ptxas.string(), "-arch=sm_90", in.string(), "-o", out.string()}, scratch, said) != 0)
    throw std::runtime_error("ptxas: " + said.substr(0, said.find('\n')));
  return read_cubin(out);
}

}  // namespace graze::cuda
