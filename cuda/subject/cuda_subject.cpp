// SPDX-License-Identifier: Apache-2.0
#include "cuda/subject/cuda_subject.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <sstream>

#include "core/cannot.h"
#include "core/error.h"
#include "core/fnv1a.h"
#include "core/plain_file.h"
#include "core/programs/kept_file.h"
#include "core/programs/run_program.h"
#include "cuda/subject/machine_code.h"
#include "cuda/subject/nvrtc.h"
#include "cuda/subject/twin_build.h"
#include "cuda/subject/wrapper.h"
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
