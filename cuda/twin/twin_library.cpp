// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/twin_library.h"

#include <dlfcn.h>

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <thread>

namespace graze::cuda {
namespace {

constexpr std::size_t kPart = 1 << 13;  // pairs that a thread takes at a time

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

// Splits the pairs among threads, which call decide(pairs, answers).
template <class AnyPair, class Decide>
void on_all_cores(std::span<const AnyPair> pairs, std::int8_t* answers, const Decide& decide) {
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t at = next.fetch_add(kPart); at < pairs.size(); at = next.fetch_add(kPart))
      decide(pairs.subspan(at, std::min(kPart, pairs.size() - at)), answers + at);
  };
  const std::size_t parts = (pairs.size() + kPart - 1) / kPart;
  std::vector<std::thread> threads;
  for (std::size_t t = 1; t < std::min<std::size_t>(parts, std::thread::hardware_concurrency()); ++t)
    threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
}

}  // namespace

TwinLibrary::TwinLibrary(const std::filesystem::path& file, Scalar scalar)
    : library_(dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)), scalar_(scalar) {
  if (!library_) throw std::runtime_error(dlerror());
  const auto symbol = [&](const char* name) {
    void* found = dlsym(library_, name);
    if (!found) throw std::runtime_error(file.string() + ": expected a twin, found no " + name);
    return found;
  };
  if (reinterpret_cast<int (*)()>(symbol("graze_twin_is_f64"))() != (scalar == Scalar::f64))
    throw std::runtime_error(file.string() + ": expected a twin in " + std::string(name(scalar)));
  block_ = symbol("graze_twin_decide_block");
  fusing_ = symbol("graze_twin_decide_fusing");
  comparisons_ = {reinterpret_cast<const ComparisonSite* (*)()>(symbol("graze_twin_comparisons"))(),
                  static_cast<std::size_t>(reinterpret_cast<int (*)()>(symbol("graze_twin_comparison_count"))())};
  const int count = reinterpret_cast<int (*)()>(symbol("graze_twin_site_count"))();
  for (int s = 0; s < count; ++s) {
    const auto text = [&](const char* name) { return reinterpret_cast<const char* (*)(int)>(symbol(name))(s); };
    const auto number = [&](const char* name) { return reinterpret_cast<int (*)(int)>(symbol(name))(s); };
    sites_.push_back({text("graze_twin_site_file"), number("graze_twin_site_line"), text("graze_twin_site_from_file"),
                      number("graze_twin_site_from_line"), number("graze_twin_site_by_ptxas") != 0});
  }
}

TwinLibrary::~TwinLibrary() { dlclose(library_); }

void TwinLibrary::decide(std::span<const Pair> pairs, std::int8_t* answers) const {
  on_all_cores(pairs, answers, [&](auto part, auto* to) { decide_part(block_, scalar_, part, to); });
}
void TwinLibrary::decide(std::span<const DoublePair> pairs, std::int8_t* answers) const {
  on_all_cores(pairs, answers, [&](auto part, auto* to) { decide_part(block_, scalar_, part, to); });
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
