// SPDX-License-Identifier: Apache-2.0
// Proves the twins on a device, over all strata, for every CUDA lane. The proof compares verdicts and trace hashes of
// the default build with those of the explicit PTX. The driver assembles the explicit PTX, in which every contraction
// is written out. A sample of the pairs also goes to the twin, which is generated from the explicit PTX.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/variants.h"

namespace graze::cuda {

struct ProofOptions {
  std::uint64_t pairs = 10'000'000'000;    // pairs for each lane, over all strata
  std::uint64_t twin_pairs = 100'000'000;  // how many of these pairs the twin also decides
  std::uint64_t seed = 1;
  bool of_doubles = false;              // true: pairs of doubles and lanes in double; false: float32 pairs
  std::vector<std::string> lanes = {};  // shell patterns of names; empty: all CUDA lanes
  bool wrong_rule = false;  // the explicit PTX contracts the right product first, so differences must appear
  std::function<void(const std::string& line)> progress = nullptr;  // called after each stratum
};

inline constexpr std::uint32_t kExamples = 8;  // the most examples of a stratum

// The numbers of compared pairs, and of differences in verdicts and in trace hashes.
struct StratumProof {
  std::string stratum;
  std::uint64_t pairs = 0, verdict_differences = 0, trace_differences = 0;  // default build against explicit PTX
  std::uint64_t twin_pairs = 0, twin_verdict_differences = 0, twin_trace_differences = 0;  // default build against twin
  std::vector<std::uint64_t> examples = {};  // indices of a few pairs that differ
};

struct LaneProof {
  std::string lane;
  std::string hash, trace_hash;  // hashes of the two kernels; see TwinFunctions in twin.h
  std::vector<StratumProof> strata;

  std::uint64_t pairs() const;
  std::uint64_t differences() const;
  std::uint64_t twin_pairs() const;
  std::uint64_t twin_differences() const;
  bool verified() const { return pairs() > 0 && twin_pairs() > 0 && differences() == 0 && twin_differences() == 0; }
};

struct ProofRecord {
  std::string device, driver, toolkit;
  std::uint64_t seed = 0;
  double seconds = 0;
  std::vector<LaneProof> lanes;

  bool verified() const;  // whether every lane is verified
};

// Throws: std::runtime_error without a device, or on any CUDA error.
ProofRecord prove_twin(const ProofOptions& options);

// The PTX of the variant's kernels with every contraction written out, as text for the driver to assemble. wrong_rule:
// with wrong contractions.   Throws: std::invalid_argument for a variant without a twin.
std::string explicit_ptx(Variant variant, bool wrong_rule);

// The record, in the format of the files in cuda/proofs.
nlohmann::ordered_json to_json(const ProofRecord& record);

}  // namespace graze::cuda
