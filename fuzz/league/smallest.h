// SPDX-License-Identifier: Apache-2.0
// The league's smallest failures: one minimised pair for each subject, shape and wrong verdict. Each failure is
// repeated in a fresh process, which has seen no other pair.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/simplify/simplicity.h"
#include "fuzz/league/league.h"

namespace graze::fuzz {

// The lane's verdicts on these pairs, decided in a new process.
template <class Real>
std::vector<Verdict> verdicts_in_fresh_process(const Lane& lane, const std::vector<BasicPair<Real>>& pairs);

struct Candidate {
  const Lane* lane;
  std::string shape;
  Verdict says;  // the wrong verdict
  AnyPair pair;
  bool lane_dies;  // the lane crashed or did not return on some pair
};

// Keeps one lane's simplest pair for each shape and wrong verdict. The order in which pairs are added does not matter.
class Smallest {
 public:
  void add(std::string_view shape, Verdict says, const AnyPair& pair);
  void add_candidates(const Lane& lane, std::vector<Candidate>& candidates) const;

 private:
  std::map<std::pair<std::string, Verdict>, std::pair<Simplicity, AnyPair>> pairs_;
};

// Minimises the first candidate of each subject, shape and verdict. If another subject's pair is simpler and this lane
// fails on it in the same way, that pair is used instead.
// candidates: in the order of the lanes.   not_repeated: receives the number of failures that are left out.
// Returns: the failures that a fresh process repeats.   Throws: OracleMismatch.
std::vector<LeagueFailure> smallest_failures(const std::vector<Candidate>& candidates, std::uint64_t& not_repeated);

}  // namespace graze::fuzz
