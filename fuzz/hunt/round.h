// SPDX-License-Identifier: Apache-2.0
// A round of guided search: libFuzzer, in a process of its own, changes pairs of a corpus, and keeps those that show
// something new. What it finds is a function of the task alone.
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

// A pair that showed these features when no pair before it did.
struct Unit {
  Pair pair;
  Features features;
};

struct MutationCounts {
  std::uint64_t pairs = 0;          // that it led to, as the last of up to five mutations in a row
  std::uint64_t disagreements = 0;  // of them
  std::uint64_t units = 0;          // of them; by the round they are in
};

struct FoundPair {
  Pair pair;
  Mutation mutation;
};

struct RoundTask {
  const Campaign* campaign;  // its lanes are of the host or foreign, or have twins
  const Drawn* drawn;
  PairRange range;  // the numbers of its pairs
  const std::vector<Unit>* corpus;
};

struct RoundResult {
  explicit RoundResult(int lanes) : counts(lanes) {}

  StoredCounts counts;
  std::vector<Unit> units;                  // in the order in which they were found
  std::map<std::uint64_t, FoundPair> kept;  // the cases of `counts`, by their numbers
  std::array<MutationCounts, kMutationCount> mutations{};
};

// Whether this build has libFuzzer.
bool has_libfuzzer();

// Starts a round in a new process, which leaves its result, or what went wrong, in the file.
// Requires: has_libfuzzer().   Throws: std::runtime_error.
pid_t start_round(const RoundTask& task, const std::filesystem::path& file);

// What the process left.   Throws: OracleMismatch, std::runtime_error, where something went wrong in it.
RoundResult round_result(const RoundTask& task, const std::filesystem::path& file);

}  // namespace graze::fuzz
