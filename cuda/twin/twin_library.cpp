// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/twin_library.h"

#include <dlfcn.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

namespace graze::cuda {
namespace {

constexpr std::size_t kPart = 1 << 13;  // the most pairs that a thread takes at a time

using Block32 = void (*)(const float*, std::size_t, signed char*);
using Block64 = void (*)(const double*, std::size_t, signed char*);

void decide_part(void* block, Scalar scalar, std::span<const DoublePair> pairs, signed char* answers) {
  if (scalar != Scalar::f64) throw std::logic_error("a twin in float cannot decide doubles");
  reinterpret_cast<Block64>(block)(coordinates(pairs[0]), pairs.size(), answers);
}
void decide_part(void* block, Scalar scalar, std::span<const Pair> pairs, signed char* answers) {
  if (scalar == Scalar::f32) return reinterpret_cast<Block32>(block)(coordinates(pairs[0]), pairs.size(), answers);
  std::vector<DoublePair> wide;
  for (const Pair& pair : pairs) wide.push_back(in_doubles(pair));
  decide_part(block, scalar, wide, answers);
}

template <class AnyPair>
void decide_on_all_cores(void* block, Scalar scalar, std::span<const AnyPair> pairs, std::int8_t* answers) {
  tbb::parallel_for(std::size_t{0}, (pairs.size() + kPart - 1) / kPart, [&](std::size_t part) {
    const std::size_t first = part * kPart;
    decide_part(block, scalar, pairs.subspan(first, std::min(kPart, pairs.size() - first)), answers + first);
  });
}

}  // namespace

TwinLibrary::TwinLibrary(const std::filesystem::path& file, Scalar scalar)
    : library_(dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)), scalar_(scalar) {
  if (!library_) throw std::runtime_error(dlerror());
  const auto symbol = [&](const char* name) {
    void* found = dlsym(library_, name);
    if (!found) throw std::runtime_error(file.string() + " is not a twin: it has no symbol " + name);
    return found;
  };
  if (reinterpret_cast<int (*)()>(symbol("graze_twin_is_f64"))() != (scalar == Scalar::f64))
    throw std::runtime_error(file.string() + " is not a twin in " + std::string(name(scalar)));
  block_ = symbol("graze_twin_decide_block");
  fusing_ = symbol("graze_twin_decide_fusing");
  const auto number = [&](const char* name) {
    return static_cast<std::size_t>(reinterpret_cast<int (*)()>(symbol(name))());
  };
  comparisons_ = {reinterpret_cast<const ComparisonSite* (*)()>(symbol("graze_twin_comparisons"))(),
                  number("graze_twin_comparison_count")};
  sites_ = {reinterpret_cast<const ContractionSite* (*)()>(symbol("graze_twin_sites"))(),
            number("graze_twin_site_count")};
}

TwinLibrary::~TwinLibrary() { dlclose(library_); }

void TwinLibrary::decide(std::span<const Pair> pairs, std::int8_t* answers) const {
  decide_on_all_cores(block_, scalar_, pairs, answers);
}
void TwinLibrary::decide(std::span<const DoublePair> pairs, std::int8_t* answers) const {
  decide_on_all_cores(block_, scalar_, pairs, answers);
}

int TwinLibrary::decide_fusing(const AnyPair& pair, std::span<const std::uint64_t> fused, std::span<Comparison> made,
                               std::size_t* count) const {
  if (fused.size() * 64 < sites_.size()) throw std::invalid_argument("decide_fusing: too few bits for the sites");
  std::size_t stored = 0;
  int answer = 0;
  const auto run = [&]<class Real>(const Real* coordinates) {
    using Decide = int (*)(const Real*, const std::uint64_t*, Comparison*, std::size_t, std::size_t*);
    answer = reinterpret_cast<Decide>(fusing_)(coordinates, fused.data(), made.data(), made.size(), &stored);
  };
  if (scalar_ == Scalar::f32) {
    const Pair floats = pair.in_float32();
    run(coordinates(floats));
  } else {
    run(coordinates(pair.doubles));
  }
  if (count) *count = stored;
  return answer;
}

}  // namespace graze::cuda
