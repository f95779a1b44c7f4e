// SPDX-License-Identifier: Apache-2.0
#include "cuda/subject/cuda_subject.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <optional>
#include <regex>
#include <sstream>
#include <utility>

#include "core/cannot.h"
#include "core/error.h"
#include "core/fnv1a.h"
#include "core/pattern.h"
#include "core/plain_file.h"
#include "core/programs/kept_file.h"
#include "core/programs/run_program.h"
#include "cuda/subject/machine_code.h"
#include "cuda/subject/nvrtc.h"
#include "cuda/twin/generator/cpp_writer.h"
#include "cuda/twin/generator/ptx_writer.h"
#include "cuda/twin/generator/reduce.h"

namespace graze::cuda {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& path) {
  std::string why;
  if (auto text = plain_file(path, why)) return *text;
  throw UsageError(cannot("read", path, why));
}

constexpr char kWrapper[] = R"(
#line 1 "graze"
namespace graze_subject_wrapper {{
__device__ inline signed char answer(bool is) {{ return is; }}
__device__ inline signed char answer(int said) {{ return said < 0 ? -1 : said != 0; }}
}}
extern "C" __global__ void graze_subject_kernel(const {0}* coordinates, unsigned stride, unsigned count,
                                                signed char* answers) {{
  const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= count) return;
  {0} a[9], b[9];
  for (unsigned k = 0; k < 9; ++k) {{
    a[k] = coordinates[(unsigned long long)k * stride + i];
    b[k] = coordinates[(unsigned long long)(k + 9) * stride + i];
  }}
  const {0} (&p)[9] = a, (&q)[9] = b;
  answers[i] = graze_subject_wrapper::answer({1}(p, q));
}}
)";

// The first error in the compiler's log, as "FILE:LINE: message".
std::string first_error(const std::string& log) {
  static const std::regex kError(R"((.*?)\((\d+)\): (?:catastrophic )?error: (.*))");
  std::istringstream lines(log);
  std::string first, other;
  for (std::string line; std::getline(lines, line);) {
    line.resize(std::min(line.size(), kMostMatched));
    if (std::smatch match; matches(line, match, kError))
      return fmt::format("{}:{}: {}", match[1].str(), match[2].str(), match[3].str());
    if (first.empty()) first = line;
    if (other.empty() && line.find("error") != line.npos) other = line;
  }
  return other.empty() ? first : other;
}

std::string with_lines(const std::string& text, const fs::path& source) {
  return fmt::format("#line 1 \"{}\"\n{}", source.string(), text);
}

// The source, followed by the kernel kSubjectKernel. The source's lines keep their numbers.
std::string wrapped(const std::string& text, const fs::path& source, const std::string& function, Scalar scalar) {
  return with_lines(text, source) + fmt::format(kWrapper, scalar == Scalar::f32 ? "float" : "double", function);
}

// The function's scalar type; float if the function takes both types. `compile` throws CompileError.
// Throws: UsageError, one line with the user's file and line, when the source does not compile. Also throws UsageError
// when no function with that name takes two triangles; the message then names the type that was found.
Scalar scalar_of(const std::string& text, const fs::path& source, const std::string& function,
                 const std::function<std::string(const std::string& whole)>& compile) {
  if (!matches(function, std::regex("(::)?[A-Za-z_]\\w*(::[A-Za-z_]\\w*)*")))
    throw UsageError(fmt::format("{}: expected the name of a function, found '{}'", source.string(), function));
  std::string log;
  for (const Scalar scalar : {Scalar::f32, Scalar::f64}) {
    try {
      compile(wrapped(text, source, function, scalar));
      return scalar;
    } catch (const CompileError& error) {
      if (log.empty()) log = error.what();
    }
  }
  const std::string expected =
      fmt::format("{}: expected __device__ bool {}(const float a[9], const float b[9]), or int, or with double",
                  source.string(), function);
  try {
    compile(with_lines(text, source));
  } catch (const CompileError& error) {
    throw UsageError(first_error(error.what()));
  }
  try {  // the error message about an undefined template names the function's type
    compile(with_lines(text, source) + fmt::format("\ntemplate <class T> struct graze_found;\n"
                                                   "graze_found<decltype(&{})> graze_type;\n",
                                                   function));
  } catch (const CompileError& error) {
    static const std::regex kType("incomplete type \"?graze_found<(.*?)>\"? ");
    const std::string said = error.what();
    std::smatch match;
    if (said.find("is undefined") != said.npos || said.find("has no member") != said.npos)
      throw UsageError(expected + "; found no function of that name");
    const std::string type = said.substr(std::min(said.find("incomplete type"), said.size()), kMostMatched);
    if (std::regex_search(type, match, kType))
      throw UsageError(
          fmt::format("{}; found {}", expected, std::regex_replace(match[1].str(), std::regex("__nv_bool"), "bool")));
    if (said.find("overloaded") != said.npos)
      throw UsageError(fmt::format("{}; found several functions of that name, none of that type", expected));
  }
  throw UsageError(fmt::format("{}; {}", expected, first_error(log)));
}

std::vector<std::string> options(Variant variant, const fs::path& source, const std::vector<std::string>& flags) {
  std::vector<std::string> all = {"--gpu-architecture=compute_75", "-lineinfo", "-default-device",
                                  "-I" + (source.has_parent_path() ? source.parent_path().string() : ".")};
  std::istringstream words{std::string(info_of(variant).flags)};
  for (std::string word; words >> word;) all.push_back(word);
  all.insert(all.end(), flags.begin(), flags.end());
  return all;
}

twin::Module module_of(const CudaBuild& build, const fs::path& source) {
  std::istringstream in(build.ptx);
  twin::Module module =
      twin::read_ptx(in, fmt::format("{}, PTX of {}", source.filename().string(), name(build.variant)));
  return twin::reduced(module, kSubjectKernel);
}

// The names and texts of subject.h, the headers of the twins' operations and twin_exports.inl.
constexpr std::pair<const char*, const char*> kTwinText[] = {
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

// A file's text without its includes of project headers, whose text comes earlier.
std::string without_own_includes(const std::string& file) {
  std::istringstream in(file);
  std::string text;
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("#include \"") && line != "#pragma once") text += line + "\n";
  }
  return text;
}

std::string source_of(const twin::Module& module, Scalar scalar) {
  std::string text;
  for (const auto& [file, whole] : kTwinText) text += without_own_includes(whole);
  std::ostringstream kernels;
  kernels << "using Real = " << name(scalar) << ";\n";
  twin::write_cpp(kernels, module, twin::Rule::ptxas);
  constexpr std::string_view kMark = "#include GRAZE_TWIN_KERNELS\n";
  text.replace(text.find(kMark), kMark.size(), kernels.str());
  return text;
}

// The twin of the module's only kernel: a library in `cache`, which is built if it is missing. The library exports
// graze_subject (see subject.h) and the symbols that cuda/twin/twin_library.h reads. The file name contains a hash of
// the twin's source, the compiler and the flags.
// Throws: twin::PtxError for an instruction that cannot be replayed; std::runtime_error when the compiler fails.
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

// Whether ptxas generates the same code for the PTX and for the explicit PTX. A file in `cache` keeps the result.
bool same_machine_code(const CudaBuild& build, const twin::Module& module, const fs::path& ptxas,
                       const fs::path& cache) {
  std::ostringstream written;
  twin::write_explicit(written, module, twin::Rule::ptxas);
  std::error_code none;
  const auto changed = fs::last_write_time(ptxas, none).time_since_epoch().count();
  const std::uint64_t hash =
      fnv1a(fmt::format("{} {}", ptxas.string(), changed), fnv1a(written.str(), fnv1a(build.ptx)));
  const fs::path kept = cache / fmt::format("code-{:016x}", hash);
  if (const auto verdict = kept_content(kept)) return *verdict == "1";

  const Scratch scratch(cache);
  bool same = true;
  const auto built = assemble(ptxas, build.ptx, scratch.path());
  for (const auto& [kernel, code] : assemble(ptxas, written.str(), scratch.path()))
    same = same && built.contains(kernel) && built.at(kernel) == code;
  const fs::path verdict = scratch.path() / "verdict";
  if (!(std::ofstream(verdict) << (same ? '1' : '0')).flush())
    throw std::runtime_error("cannot write " + verdict.string());
  keep_file(verdict, kept);
  return same;
}

void add_twin(CudaBuild& build, const twin::Module& module, const fs::path& ptxas, const fs::path& cache) {
  try {
    build.hash = twin::module_hash(module);
    build.twin = build_twin(module, build.scalar, info_of(build.variant).arithmetic != Arithmetic::rounded, cache);
    if (!ptxas.empty()) build.machine_code_identical = same_machine_code(build, module, ptxas, cache);
  } catch (const std::runtime_error& error) {
    build.twin.clear();
    build.why_no_twin = error.what();
  }
}

}  // namespace

std::string evidence(const CudaBuild& build) {
  if (build.twin.empty()) return "no twin: " + build.why_no_twin;
  return build.machine_code_identical ? "twin, machine code identical" : "twin, not yet verified";
}

std::vector<CudaBuild> build_cuda_subject(const fs::path& source, const std::string& function,
                                          const std::vector<std::string>& flags, const fs::path& cache,
                                          std::optional<Variant> only) {
  const std::string text = content(source);
  const Nvrtc& nvrtc = Nvrtc::get();
  const fs::path ptxas = find_ptxas(nvrtc.library());
  const auto compile = [&](Variant variant, const std::string& whole) {
    return nvrtc.ptx(whole, source.string(), options(variant, source, flags));
  };
  const Scalar scalar =
      scalar_of(text, source, function, [&](const std::string& whole) { return compile(Variant::cuda_nofma, whole); });
  const std::string whole = wrapped(text, source, function, scalar);
  std::vector<CudaBuild> builds;
  twin::Lines by_hand;  // source lines that have an fma even without contraction
  for (const Variant variant : {Variant::cuda_nofma, Variant::cuda_fma, Variant::cuda_fast, Variant::cuda_ftz}) {
    if (only && variant != *only && variant != Variant::cuda_nofma) continue;
    CudaBuild& build = builds.emplace_back();
    build.variant = variant;
    build.scalar = scalar;
    build.ptx = compile(variant, whole);
    try {
      twin::Module module = module_of(build, source);
      build.toolkit = module.toolkit;
      if (variant == Variant::cuda_nofma) by_hand = twin::lines_with_fma(module);
      twin::mark_by_hand(module, by_hand);
      if (!only || variant == *only) add_twin(build, module, ptxas, cache);
    } catch (const twin::PtxError& error) {
      build.why_no_twin = error.what();
    }
  }
  if (only) std::erase_if(builds, [&](const CudaBuild& build) { return build.variant != *only; });
  return builds;
}

}  // namespace graze::cuda
