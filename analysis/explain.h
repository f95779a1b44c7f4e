// SPDX-License-Identifier: Apache-2.0
// Explains why lanes are wrong on a pair: what they computed, what exact arithmetic gives, and what would have helped.
#pragma once

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/blame.h"
#include "analysis/deciding.h"
#include "analysis/lane_trace.h"
#include "analysis/neighbours.h"
#include "core/any_pair.h"
#include "core/lanes/lanes.h"
#include "oracle/precise.h"
#include "oracle/truth.h"

namespace graze::analysis {

// The cause is the first of these whose condition holds:
//   stored       for a pair of doubles and a lane in float32: the pair as float32 stores it has another truth, and the
//                lane gives that truth; or float32 cannot hold one of the numbers. All other causes of a lane in
//                float32 refer to the stored pair
//   logic        the algorithm gives the wrong verdict in exact arithmetic too
//   contraction  the same source without contraction, on the same kind of processor, is right
//   fast math    the same condition, for a lane whose operations the compiler may rewrite or approximate
//   overflow, underflow   without contraction, and with the scalar's mantissa but unlimited exponents, the lane is
//                right. The cause is overflow if the upper limit alone makes it wrong, and underflow if the lower limit
//                alone does. If both or neither do, the cause is the limit that is exceeded first. Pairs that also need
//                a longer mantissa are included, if the limit made the comparison go wrong
//   rounding     no other condition holds
// For foreign code, experiments find the cause (experiments.h). The causes from absolute_epsilon on apply only to
// foreign code, except for stored and policy:
//   policy       the lane uses a policy, and the same lane without the policy is right, or the policy declined. If
//                that lane is wrong too, the cause is that lane's, and is reported as not settled.
enum class Cause {
  rounding,
  contraction,
  fast_math,
  overflow,
  underflow,
  logic,
  absolute_epsilon,
  order_dependent,
  degenerate_input,
  crash,
  no_answer,
  unstable,
  policy,
  relative_epsilon,
  uninitialised,
  excess_precision,
  stored
};
std::string_view name(Cause cause);

// The result of the audit of the cause (analysis/audit.h).
enum class Settled {
  yes,
  not_without,  // removing the cause leaves the verdict wrong
  not_alone,    // the cause alone does not make the verdict wrong
  not_by_few,   // no correction of up to kMostDeciding comparisons makes the verdict right (deciding.h)
  unknown       // the lane's computation is not known, or no experiment shows the cause
};
std::string_view name(Settled settled);

// A value that the algorithm passed to its policy, or a comparison.
struct Step {
  std::string line;                        // "core/algorithms/moller_1997.h:96"
  std::string_view site;                   // site of the value or comparison; empty for the algorithm's own comparison
  std::string_view relation;               // empty for a value
  oracle::Beside left, right, difference;  // a single value is in `left`
  bool held = true;                        // in the lane's arithmetic
  bool holds = true;                       // in exact arithmetic
  bool wrong() const { return held != holds; }
  // Whether these numbers have no exact values, because exact arithmetic divides by zero before it reaches them.
  bool is_undefined() const { return std::isnan(left.exact) || std::isnan(right.exact); }
};

// Counts over pairs with the same truth: the lane is wrong on `wrong` of the `of` pairs.
struct WrongOf {
  int wrong, of;
};

struct LaneExplanation {
  const Lane* lane;
  Verdict verdict;
  Cause cause;
  oracle::Exactly exactly;        // the algorithm's verdict in exact arithmetic
  Evidence evidence;              // how certain it is that the steps are the lane's own
  std::vector<Step> steps;        // in order: values and comparisons passed to the policy, and wrong comparisons
  Contraction rule;               // the contraction rule of the replay
  std::vector<Decider> deciding;  // the comparisons that decide, see deciding.h; empty for logic
  int decisive = -1;              // index in `steps` of the first deciding comparison; -1 if none is known
  std::vector<Step> then;         // the other deciding comparisons; each is wrong once the earlier ones are corrected
  Blame contractions;             // only for a cuda-fma lane whose verdict contraction changes
  bool cpu_is_right = false;      // for users' CUDA code with contractions: the cpu lane of the same source is right
  Settled settled;
  int bits_needed;  // the shortest mantissa, no shorter than the lane's, that gives the right verdict without exponent
                    // limits, as does every longer one up to kMostBits; 0 if there is none, or if it may be chance
                    // (see explain.cpp)
  bool bits_alone;  // whether these bits are enough with the scalar's exponents
  std::array<bool, kCoordinates> matters;  // false: no nudge of the coordinate changes the truth or the lane's verdict
  WrongOf orders, mirrored, scalings;      // see neighbours.h
  std::string experiment;  // for lanes without steps (foreign, under a policy, or `stored`): the evidence for the cause
  std::string line;        // for foreign code: "mine.cpp:9", the line that decides; empty if it is not known
  bool slow = false;       // for lanes without steps: other pairs time out or fail, so no neighbours were tried
  bool beyond = false;     // for the cause `stored`: float32 cannot hold a number of the pair

  // Whether the lane's steps are not known, so that the account comes from experiments.
  bool by_experiment() const { return lane->foreign || lane->under || cause == Cause::stored; }

  // The comparison to report: the first deciding one. Null if there is none, or if the algorithm itself is to blame.
  const Step* told() const { return decisive < 0 ? nullptr : &steps[static_cast<std::size_t>(decisive)]; }
};

struct Explanation {
  AnyPair pair;
  oracle::Truth truth;
  std::vector<LaneExplanation> lanes;  // wrong lanes, in the given order
  std::vector<const Lane*> outside;    // lanes that differ from the truth because their convention excludes the pair
};

// Explains each lane that is wrong on the pair; CUDA lanes run as twins. Deterministic.
// Requires: lanes that run here or have a twin. For a pair with a non-finite coordinate, no lane is wrong.
Explanation explain(const AnyPair& pair, std::span<const Lane* const> lanes);

// Explains each wrong lane, but without the pair's neighbours: bits_needed, matters, orders, mirrored and scalings are
// not set. Much faster than `explain`. Lanes that differ only by their convention (convention.h) are not wrong.
std::vector<LaneExplanation> accounts(const AnyPair& pair, Verdict truth, std::span<const Lane* const> lanes);

// Returns only the cause that `explain` gives. Takes 1/20 of the time of `explain`, or 1/3 for rounding.
// Requires: the lane runs here or has a twin, and is wrong on the pair; truth is the pair's.
Cause cause_of(const Lane& lane, const AnyPair& pair, Verdict truth);

// Whether a result leaves the scalar's exponent range when the lane's source runs without contraction. If false, the
// cause is neither overflow nor underflow. The check is fast because it reads the processor's floating-point flags, but
// it may return true even if no result leaves the range. Returns false for foreign code and lanes under a policy, for
// which the answer is not known.
bool leaves_exponents(const Lane& lane, const AnyPair& pair);

// Returns one English sentence about a wrong algorithm, for a bug report; empty if none of its lanes is wrong. The
// sentence names the lanes that are wrong in the same way, and has the numbers of one of them.
std::string sentence(const Explanation& explanation, const AlgorithmInfo* subject);

// Returns one sentence for each wrong algorithm. For a user's CUDA code, a second sentence names the lines that make
// its verdict differ from the cpu lane's, if rounding only the products of these lines gives the cpu lane's verdict.
std::vector<std::string> sentences(const Explanation& explanation);

// Whether the sentence names lines that make CUDA code differ from the cpu lane.
bool tells_difference_from_cpu(std::string_view sentence);

nlohmann::ordered_json to_json(const LaneExplanation& lane);
nlohmann::ordered_json to_json(const Explanation& explanation);

}  // namespace graze::analysis
