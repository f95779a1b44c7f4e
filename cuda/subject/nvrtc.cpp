// SPDX-License-Identifier: Apache-2.0
#include "cuda/subject/nvrtc.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>

#include "core/programs/child.h"
#include "core/stop.h"
#include "cuda/subject/headers.h"

namespace graze::cuda {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> places() {
  std::vector<fs::path> all = {""};  // "" stands for the library path
  for (const char* variable : {"CUDA_HOME", "CUDA_PATH"}) {
    if (const char* home = std::getenv(variable)) all.push_back(fs::path(home) / "lib64");
  }
  std::error_code none;
  all.push_back("/usr/local/cuda/lib64");
  for (const auto& entry : fs::directory_iterator("/usr/local", none)) {
    if (entry.path().filename().string().starts_with("cuda-")) all.push_back(entry.path() / "lib64");
  }
  all.push_back(fs::read_symlink("/proc/self/exe", none).parent_path());
  return all;
}

// Runs the work in a child process, because NVRTC may crash, catch signals or never finish.
// Returns: the work's result.   Throws: CompileError or std::runtime_error, if the work does; Stopped, within 0.1 s of
// a request to stop.
std::string in_child(const std::function<std::string()>& work) {
  const StopSignals stops;
  Child child([&](int pipe) {
    std::string said;
    try {
      said = "r" + work();
    } catch (const CompileError& error) {
      said = std::string("c") + error.what();
    } catch (const std::exception& error) {
      said = std::string("e") + error.what();
    }
    write_all(pipe, said.data(), said.size());
  });
  std::string said;
  char bytes[65536];
  for (ssize_t count = 1; count > 0;) {
    if (stop_requested) throw Stopped{};
    pollfd news{child.pipe(), POLLIN, 0};
    if (poll(&news, 1, 50) <= 0) continue;
    count = read(child.pipe(), bytes, sizeof bytes);
    if (count > 0) said.append(bytes, static_cast<std::size_t>(count));
  }
  if (stop_requested) throw Stopped{};
  if (!child.succeeded() || said.empty()) throw std::runtime_error("NVRTC crashed on this source");
  if (said[0] == 'c') throw CompileError(said.substr(1));
  if (said[0] == 'e') throw std::runtime_error(said.substr(1));
  return said.substr(1);
}

template <class Function>
void find(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(dlsym(library, name));
  if (!function)
    throw std::runtime_error(
        fmt::format("this NVRTC has no function {}; install NVRTC of the CUDA Toolkit 12 or 13", name));
}

}  // namespace

Nvrtc::Nvrtc() {
  void* library = nullptr;
  for (const char* name : {"libnvrtc.so.13", "libnvrtc.so.12", "libnvrtc.so"}) {
    for (const fs::path& place : places()) {
      if (!library) library = dlopen((place.empty() ? fs::path(name) : place / name).c_str(), RTLD_NOW | RTLD_LOCAL);
    }
  }
  if (!library)
    throw std::runtime_error(
        "cannot find NVRTC of the CUDA Toolkit (libnvrtc.so.13 or .12); install the toolkit, or its package "
        "cuda-nvrtc, and set CUDA_HOME if it is in an unusual folder");
  int (*get_version)(int*, int*) = nullptr;
  find(library, "nvrtcVersion", get_version);
  find(library, "nvrtcCreateProgram", create_);
  find(library, "nvrtcDestroyProgram", destroy_);
  find(library, "nvrtcCompileProgram", compile_);
  find(library, "nvrtcGetPTXSize", ptx_size_);
  find(library, "nvrtcGetPTX", ptx_);
  find(library, "nvrtcGetProgramLogSize", log_size_);
  find(library, "nvrtcGetProgramLog", log_);
  int major = 0, minor = 0;
  get_version(&major, &minor);
  version_ = fmt::format("{}.{}", major, minor);
  Dl_info info;
  if (dladdr(reinterpret_cast<void*>(get_version), &info)) library_ = info.dli_fname;
}

const Nvrtc& Nvrtc::get() {
  static const Nvrtc nvrtc;
  return nvrtc;
}

std::string Nvrtc::ptx(const std::string& source, const std::string& name,
                       const std::vector<std::string>& options) const {
  return in_child([&] { return compiled(source, name, options); });
}

std::string Nvrtc::compiled(const std::string& source, const std::string& name,
                            const std::vector<std::string>& options) const {
  std::vector<const char*> texts, names, words;
  for (const StubHeader& header : kStubHeaders) {
    texts.push_back(header.text);
    names.push_back(header.name);
  }
  for (const std::string& option : options) words.push_back(option.c_str());
  Program program = nullptr;
  if (create_(&program, source.c_str(), name.c_str(), static_cast<int>(texts.size()), texts.data(), names.data()) != 0)
    throw std::runtime_error("NVRTC cannot create a program");
  const auto destroy = [this](Program* p) { destroy_(p); };
  const std::unique_ptr<Program, decltype(destroy)> owner(&program, destroy);
  std::size_t size = 0;
  if (compile_(program, static_cast<int>(words.size()), words.data()) != 0) {
    log_size_(program, &size);
    std::string log(size, 0);
    log_(program, log.data());
    throw CompileError(log.c_str());
  }
  ptx_size_(program, &size);
  std::string result(size, 0);
  if (ptx_(program, result.data()) != 0) throw std::runtime_error("NVRTC returns no PTX");
  result.resize(result.find_last_not_of('\0') + 1);
  return result;
}

}  // namespace graze::cuda
