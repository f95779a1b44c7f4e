// SPDX-License-Identifier: Apache-2.0
// A twin of a user's kernel, loaded into this process: its answers, contraction sites and comparisons.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "core/any_pair.h"
#include "core/lanes/lanes.h"
#include "core/pair.h"
#include "cuda/twin/twin.h"

namespace graze::cuda {

// The destructor unloads the library. The library's functions may run in several threads at once. An endless loop or an
// invalid memory access in the user's code hangs or crashes this process.
class TwinLibrary {
 public:
  // Throws: std::runtime_error if the file is not a twin for this scalar.
  TwinLibrary(const std::filesystem::path& file, Scalar scalar);
  TwinLibrary(const TwinLibrary&) = delete;
  TwinLibrary& operator=(const TwinLibrary&) = delete;
  ~TwinLibrary();

  // Writes an answer for each pair: -1 for declined, 0 for disjoint, 1 for intersects. Uses several threads for many
  // pairs. If the kernel ends without an answer for a pair, that answer is left unchanged.
  void decide(std::span<const Pair> pairs, std::int8_t* answers) const;
  // Requires: a twin in double.
  void decide(std::span<const DoublePair> pairs, std::int8_t* answers) const;

  std::span<const ContractionSite> sites() const { return sites_; }
  std::span<const ComparisonSite> comparisons() const { return comparisons_; }

  // The answer if only the sites whose bit is set are fused. Bit i % 64 of word i / 64 belongs to site i. `made`
  // receives the first comparisons that the kernel makes, as many as fit, and `count` the number of those. A twin in
  // float decides a pair of doubles after rounding it to float32. Throws: std::invalid_argument for too few bits.
  int decide_fusing(const AnyPair& pair, std::span<const std::uint64_t> fused, std::span<Comparison> made = {},
                    std::size_t* count = nullptr) const;

 private:
  void* library_;
  Scalar scalar_;
  void* block_ = nullptr;
  void* fusing_ = nullptr;
  std::span<const ContractionSite> sites_;  // in the library, like comparisons_
  std::span<const ComparisonSite> comparisons_;
};

}  // namespace graze::cuda
