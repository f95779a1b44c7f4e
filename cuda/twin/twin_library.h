// SPDX-License-Identifier: Apache-2.0
// A twin of a user's kernel, loaded into this process: its answers, and its contraction sites.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"
#include "core/pair.h"

namespace graze::cuda {

// A place where the kernel rounds once and its source twice; see ContractionSite in cuda/twin/twin.h.
struct TwinSite {
  std::string file;
  int line = 0;
  std::string from_file;  // into which the function with that line is inlined; empty: into none
  int from_line = 0;
  bool by_ptxas = false;
};

// The library stays loaded with its owner. Its functions may run in several threads at once; a user's endless loop or
// wild index is endless and wild here too.
class TwinLibrary {
 public:
  // Throws: std::runtime_error when the file is no twin.
  TwinLibrary(const std::filesystem::path& file, Scalar scalar);
  TwinLibrary(const TwinLibrary&) = delete;
  TwinLibrary& operator=(const TwinLibrary&) = delete;
  ~TwinLibrary();

  // -1 declined, 0 disjoint, 1 intersects, for each pair; by several threads where there are many pairs.
  void decide(std::span<const Pair> pairs, std::int8_t* answers) const;

  const std::vector<TwinSite>& sites() const { return sites_; }

  // The answer with two roundings at every site whose bit is not set: bit i % 64 of word i / 64 is site i.
  // Throws: std::invalid_argument for too few bits.
  int decide_fusing(const Pair& pair, std::span<const std::uint64_t> fused) const;

 private:
  void* library_;
  Scalar scalar_;
  void* block_ = nullptr;
  void* fusing_ = nullptr;
  std::vector<TwinSite> sites_;
};

}  // namespace graze::cuda
