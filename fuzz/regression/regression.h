// SPDX-License-Identifier: Apache-2.0
// The regression corpus: failures that were seen, one case for each signature, all in one file of pairs, and what has
// become of them since. Nothing in it depends on the clock, and the same failures in the same order give the same
// bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/lanes/lanes.h"
#include "core/pair.h"
#include "corpus/pair_format.h"
#include "oracle/truth.h"

namespace graze::fuzz {

// failing: a lane of the signature's algorithm is wrong. fixed: all that were are right. flaky: a verdict differed
// between replays, or between a device and its twin; replays that agree later prove nothing, so it stays flaky.
enum class CaseState { failing, fixed, flaky };
std::string_view name(CaseState state);

// The mark of each lane that ran, by the lane's name: those of analysis/signature.h, and '~' where its verdict differed
// between replays.
using Marks = std::map<std::string, char>;

struct RegressionCase {
  std::string name;  // a word, unique
  Pair pair{};
  std::string truth, contact;
  CaseState state = CaseState::failing;
  std::uint64_t count = 0;  // pairs that were seen with this signature
  Marks marks;
  std::string first, last;                                      // failures; see fuzz/regression/found_failure.h
  std::vector<std::pair<std::string, std::string>> other = {};  // fields that the case came with
};

// The fields of an entry that say nothing which a case keeps itself.
std::vector<std::pair<std::string, std::string>> other_fields(const corpus::Entry& entry);

// By signature, as it was first seen.
using RegressionCorpus = std::map<std::string, RegressionCase>;

// Throws: FormatError, also for a file that is missing or holds a signature twice.
RegressionCorpus read_regressions(const std::filesystem::path& file);

// Replaces the file in one step.
void write_regressions(const std::filesystem::path& file, const RegressionCorpus& corpus);

// Each lane's verdict on a pair, and in apart the lanes that disagree with themselves; see decide in
// fuzz/selected_lanes.h.
using DecideLanes = std::function<std::vector<Verdict>(const Pair&, std::vector<const Lane*>& apart)>;

struct Replay {
  oracle::Truth truth;
  Marks marks;
};

inline constexpr int kReplays = 3;

// Runs the lanes on the pair kReplays times.
Replay replay(const Pair& pair, std::span<const Lane* const> lanes, const DecideLanes& decide);

// What a case of this signature is after a replay; `before` where the replay cannot tell.
CaseState state_after(CaseState before, const std::string& signature, const Marks& now);

struct Change {
  std::string name;  // of the case
  std::string what;  // "moller_1997/f32/cpu: was disjoint (wrong), is intersects (right)", "failing -> fixed"
};

struct Verified {
  std::vector<Change> changes;
  std::size_t compared = 0;  // verdicts that had a record
};

// Replays every case and notes in the corpus what was found: verdicts, and states.
// Returns: what differs from the record, which of an exact lane is the truth; other lanes without a record, or that did
// not run, differ from nothing.
Verified verify(RegressionCorpus& corpus, std::span<const Lane* const> lanes, const DecideLanes& decide);

}  // namespace graze::fuzz
