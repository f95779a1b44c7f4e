// SPDX-License-Identifier: Apache-2.0
// Loads NVRTC, the CUDA Toolkit's compiler as a library, at first use. This file compiles without nvcc and CUDA
// headers, and programs that do not compile CUDA run without NVRTC.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace graze::cuda {

// The compiler refused a source; what() is its whole log.
struct CompileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Nvrtc {
 public:
  // The first NVRTC on the library path, below CUDA_HOME, CUDA_PATH and /usr/local/cuda*, or in this program's folder.
  // Throws: std::runtime_error if NVRTC is not found; its one line tells what to install.
  static const Nvrtc& get();

  // Compiles the source to PTX in a separate process. `name` is the source's name in messages and line tables.
  // Throws: CompileError; Stopped; std::runtime_error if NVRTC crashes.
  std::string ptx(const std::string& source, const std::string& name, const std::vector<std::string>& options) const;

  const std::string& version() const { return version_; }  // "13.0"
  const std::string& library() const { return library_; }  // path of the loaded file

 private:
  Nvrtc();
  std::string compiled(const std::string& source, const std::string& name,
                       const std::vector<std::string>& options) const;
  using Program = void*;
  int (*create_)(Program*, const char*, const char*, int, const char* const*, const char* const*) = nullptr;
  int (*destroy_)(Program*) = nullptr;
  int (*compile_)(Program, int, const char* const*) = nullptr;
  int (*ptx_size_)(Program, std::size_t*) = nullptr;
  int (*ptx_)(Program, char*) = nullptr;
  int (*log_size_)(Program, std::size_t*) = nullptr;
  int (*log_)(Program, char*) = nullptr;
  std::string version_, library_;
};

}  // namespace graze::cuda
