// SPDX-License-Identifier: Apache-2.0
// The regression corpus: known failures with their current states, one case for each signature, in one file of pairs.
// Adding the same failures in the same order gives the same bytes, at any time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/any_pair.h"
#include "core/lanes/lanes.h"
#include "corpus/pair_format.h"
#include "oracle/truth.h"

namespace graze::fuzz {

// failing: a lane of the signature's algorithm is wrong. fixed: all lanes that were wrong are right. flaky: a verdict
// differed between replays, or between a device and its twin. A flaky case remains flaky, because later replays that
// agree prove nothing.
enum class CaseState { failing, fixed, flaky };
std::string_view name(CaseState state);

// The mark of each lane that ran, by lane name: a mark from analysis/signature.h, or '~' if the verdict differed
// between replays.
using Marks = std::map<std::string, char>;

struct RegressionCase {
  std::string name;  // unique, without spaces
  AnyPair pair;
  std::string truth, contact;
  CaseState state = CaseState::failing;
  std::uint64_t count = 0;  // pairs seen with this signature
  Marks marks;
  std::string first, last;  // where it was first and last seen; see FoundFailure::seen
  std::vector<std::pair<std::string, std::string>> other = {};  // other fields of the original entry
};

// The fields of an entry for which RegressionCase has no members.
std::vector<std::pair<std::string, std::string>> other_fields(const corpus::Entry& entry);

// The cases, each under the signature with which it was first seen.
using RegressionCorpus = std::map<std::string, RegressionCase>;

// The name of a case: its subject and a hash of its signature.
std::string case_name(const std::string& signature);

// Throws: FormatError, also if the file is missing, holds a signature twice, or has a name that does not match its
// signature.
RegressionCorpus read_regressions(const std::filesystem::path& file);

// Replaces the file atomically.
void write_regressions(const std::filesystem::path& file, const RegressionCorpus& corpus);

// Returns each lane's verdict on a pair; `apart` receives the lanes whose executors disagree. See decide in
// fuzz/selected_lanes.h.
using DecideLanes = std::function<std::vector<Verdict>(const AnyPair&, std::vector<const Lane*>& apart)>;

struct Replay {
  oracle::Truth truth;
  Marks marks;  // of the lanes that decide the pair
};

inline constexpr int kReplays = 3;

// Runs the lanes on the pair kReplays times.
Replay replay(const AnyPair& pair, std::span<const Lane* const> lanes, const DecideLanes& decide);

// The state of a case with this signature after a replay; `before` if the replay does not determine it.
CaseState state_after(CaseState before, const std::string& signature, const Marks& now);

struct Change {
  std::string name;  // of the case
  std::string what;  // "moller_1997/f32/cpu: was disjoint (wrong), is intersects (right)", "failing -> fixed"
};

struct Verified {
  std::vector<Change> changes;
  std::size_t compared = 0;  // verdicts that had a record
};

// Replays every case and updates verdicts and states in the corpus.
// Returns: the differences from the record. An exact lane without a record is compared with the truth. Other lanes
// without a record, and lanes that did not run, are not compared.
Verified verify(RegressionCorpus& corpus, std::span<const Lane* const> lanes, const DecideLanes& decide);

}  // namespace graze::fuzz
