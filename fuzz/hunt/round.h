// SPDX-License-Identifier: Apache-2.0
// A round of guided search: libFuzzer, in a separate process, mutates the pairs of a corpus and keeps pairs with new
// features. The result depends only on the task.
#pragma once

#include <sys/types.h>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

#include "fuzz/campaign/stored_counts.h"
#include "fuzz/hunt/feedback.h"
#include "fuzz/hunt/mutations.h"

namespace graze::fuzz {

// A pair that was the first to show these features.
struct Unit {
  AnyPair pair;
  Features features;
};

struct MutationCounts {
  std::uint64_t pairs = 0;          // pairs whose last mutation was this; a pair gets up to five in a row
  std::uint64_t disagreements = 0;  // of these pairs
  std::uint64_t units = 0;          // of these pairs, those kept as units, because they were new in their round
};

struct FoundPair {
  AnyPair pair;
  Mutation mutation;
};

struct RoundTask {
  const Campaign* campaign;  // its lanes run on the host, are foreign, or have twins
  const Drawn* drawn;
  PairRange range;  // the indices of its pairs
  const std::vector<Unit>* corpus;
};

struct RoundResult {
  explicit RoundResult(int lanes) : counts(lanes) {}

  StoredCounts counts;
  std::vector<Unit> units;                  // in the order in which they were found
  std::map<std::uint64_t, FoundPair> kept;  // the cases in `counts`, by pair index
  std::array<MutationCounts, kMutationCount> mutations{};
};

bool has_libfuzzer();

// Starts a round in a new process, which writes its result or error to the file.
// Requires: has_libfuzzer().   Throws: std::runtime_error.
pid_t start_round(const RoundTask& task, const std::filesystem::path& file);

// Reads the result that the process wrote.   Throws: OracleMismatch or std::runtime_error if the process failed.
RoundResult round_result(const RoundTask& task, const std::filesystem::path& file);

}  // namespace graze::fuzz
