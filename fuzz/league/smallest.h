// SPDX-License-Identifier: Apache-2.0
// The league's smallest failures: one pair of each subject, shape and wrong verdict, minimised, and shown again by a
// process that has seen no other pair.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fuzz/league/league.h"
#include "fuzz/minimise/simplicity.h"

namespace graze::fuzz {

// What the lane says in a process that has seen no pair before these.
std::vector<Verdict> verdicts_in_fresh_process(const Lane& lane, const std::vector<Pair>& pairs);

struct Candidate {
  const Lane* lane;
  std::string shape;
  Verdict says;  // wrong
  Pair pair;
  bool lane_dies;  // it crashed or did not return on some pair of the league
};

// Of one lane the simplest pair of each shape and wrong verdict. The order of adding does not matter.
class Smallest {
 public:
  void add(std::string_view shape, Verdict says, const Pair& pair);
  void add_candidates(const Lane& lane, std::vector<Candidate>& candidates) const;

 private:
  std::map<std::pair<std::string, Verdict>, std::pair<Simplicity, Pair>> pairs_;
};

// Minimises the first candidate of each subject, shape and verdict; where another subject's pair is simpler and fails
// alike, that is the subject's too. Candidates are in the order of lanes. Returns: those that a fresh process shows
// again; not_repeated: how many it does not. Throws: OracleMismatch.
std::vector<LeagueFailure> smallest_failures(const std::vector<Candidate>& candidates, std::uint64_t& not_repeated);

}  // namespace graze::fuzz
