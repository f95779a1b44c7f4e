// SPDX-License-Identifier: Apache-2.0
#include "cuda/subject/twin_build.h"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <vector>

#include "core/fnv1a.h"
#include "core/programs/kept_file.h"
#include "core/programs/run_program.h"
#include "cuda/twin/generator/cpp_writer.h"

namespace graze::cuda {
namespace {

namespace fs = std::filesystem;

// The concatenated text of subject.h, the twins' operations and twin_exports.inl, cut into pieces.
constexpr const char* kTwinText[] = {
#include "cuda/generated/twin_text.inc"
};

bool has_fma() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("fma");
#else
  return false;
#endif
}

std::string compiler() {
  const char* named = std::getenv("CXX");
  return named && *named ? named : "c++";
}

// The first line of the compiler's version text.
std::string version_of(const std::string& program, const fs::path& cache) {
  const Scratch scratch(cache);
  std::string said;
  if (run_program({{program, "--version"}}, scratch.path(), said) != 0)
    throw std::runtime_error(fmt::format("cannot run the C++ compiler '{}' ($CXX, else c++), which builds the twin: {}",
                                         program, said.substr(0, said.find('\n'))));
  return said.substr(0, said.find('\n'));
}

std::string source_of(const twin::Module& module, Scalar scalar) {
  std::string text;
  for (const char* piece : kTwinText) text += piece;
  std::ostringstream kernels;
  kernels << "using Real = " << name(scalar) << ";\n";
  twin::write_cpp(kernels, module, twin::Rule::ptxas);
  constexpr std::string_view kMark = "#include GRAZE_TWIN_KERNELS\n";
  text.replace(text.find(kMark), kMark.size(), kernels.str());
  return text;
}

}  // namespace

fs::path build_twin(const twin::Module& module, Scalar scalar, bool contracted, const fs::path& cache) {
  const std::string source = source_of(module, scalar);
  std::vector<std::string> words = {compiler(),          "-std=c++20",      "-O2", "-fPIC",           "-shared",
                                    "-ffp-contract=off", "-fno-math-errno", "-w",  "-DGRAZE_FP=twin", "-static-libgcc",
                                    "-Wl,--as-needed"};
  if (contracted && has_fma()) words.push_back("-mfma");
  words.push_back(fmt::format("-DGRAZE_TWIN_VERSION=\"nvcc {}\"", module.toolkit));
  words.push_back(fmt::format("-DGRAZE_TWIN_BLOCKS={}", scalar == Scalar::f32
                                                            ? "graze::cuda::ptx::decide_block, nullptr"
                                                            : "nullptr, graze::cuda::ptx::decide_block"));
  std::uint64_t hash = fnv1a(version_of(compiler(), cache), fnv1a(source));
  for (const std::string& word : words) hash = fnv1a(word, fnv1a(" ", hash));
  const fs::path library = cache / fmt::format("twin-{:016x}.so", hash);
  if (kept_content(library)) return library;

  const Scratch scratch(cache);
  const fs::path in = scratch.path() / "twin.cpp", out = scratch.path() / "twin.so";
  if (!(std::ofstream(in, std::ios::binary) << source).flush()) throw std::runtime_error("cannot write " + in.string());
  words.insert(words.end(), {"-o", out.string(), in.string()});
  std::string said;
  if (run_program({words}, scratch.path(), said) != 0) {
    const auto error = said.find("error");
    const auto start = error == said.npos ? 0 : said.rfind('\n', error) + 1;  // 0 without a newline
    throw std::runtime_error(
        fmt::format("{} cannot compile the twin: {}", compiler(), said.substr(start, said.find('\n', start) - start)));
  }
  keep_file(out, library);
  return library;
}

}  // namespace graze::cuda
