// SPDX-License-Identifier: Apache-2.0
// Why lanes are wrong on a pair: what they computed beside what it should have been, and what would have helped.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/blame.h"
#include "analysis/deciding.h"
#include "analysis/lane_trace.h"
#include "analysis/neighbours.h"
#include "core/lanes/lanes.h"
#include "core/pair.h"
#include "oracle/precise.h"
#include "oracle/truth.h"

namespace graze::analysis {

// The first that holds:
//   logic        the algorithm in exact arithmetic gives the wrong verdict too
//   contraction  the same source without contraction, on the same kind of processor, is right
//   fast math    the same, of a lane whose operations the compiler was allowed to rewrite or approximate
//   overflow, underflow   with the scalar's mantissa and unlimited exponents it is right, not contracted. Overflow
//                where the upper limit alone makes it wrong, underflow where the lower one alone does; where both or
//                neither do, the limit that is exceeded first. Also where a longer mantissa is needed as well, but the
//                limit made the comparison go wrong.
//   rounding     otherwise
// Of foreign code by experiments, see experiments.h; the causes from absolute_epsilon on are of foreign code alone, but
// for the last:
//   policy       of a lane under a policy: the same lane under none is right, or the policy may decline. Where that
//   lane
//                is wrong too, its cause; not settled.
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
  policy
};
std::string_view name(Cause cause);

// Whether the cause stands up to the audit of analysis/audit.h.
enum class Settled {
  yes,
  not_without,  // without it something else makes the verdict wrong as well
  not_alone,    // alone it does not make the verdict wrong
  not_by_few,   // correcting up to kMostDeciding comparisons does not make the verdict right (deciding.h)
  unknown       // what the lane computed is not known, or no experiment shows it
};
std::string_view name(Settled settled);

// A value that the algorithm asked its policy about, or a comparison.
struct Step {
  std::string line;           // "core/algorithms/moller_1997.h:96"
  std::string_view site;      // what the policy was asked about; empty for a comparison of the algorithm's own
  std::string_view relation;  // empty for a value
  oracle::Beside left, right, difference;  // a value is `left`
  bool held = true;                        // in the lane
  bool holds = true;                       // in exact arithmetic
  bool wrong() const { return held != holds; }
};

// Of how many pairs with the same truth the lane is wrong.
struct WrongOf {
  int wrong, of;
};

struct LaneExplanation {
  const Lane* lane;
  Verdict verdict;
  Cause cause;
  oracle::Exactly exactly;  // what the algorithm says in exact arithmetic
  Evidence evidence;        // how well the steps are known to be the lane's own
  std::vector<Step> steps;  // in order: values and comparisons of the policy's, and all comparisons that went wrong
  Contraction rule;         // by which the run was replayed
  std::vector<Decider> deciding;  // the comparisons that decide, see deciding.h; empty for logic
  int decisive = -1;              // the first of them, a step; -1 where none is known
  std::vector<Step> then;         // the others: each goes wrong once those before it are corrected
  Blame contractions;             // of a cuda-fma lane whose verdict contraction changes
  Settled settled;
  int bits_needed;  // least mantissa, from the lane's own on, with which and with any longer one of up to
                    // kMostBits it is right; 0 without one, and where it would be luck (see explain.cpp)
  std::array<bool, kCoordinates> matters;  // false: all its nudges leave the truth and the lane's verdict as they are
  WrongOf orders, mirrored, scalings;      // see neighbours.h
  std::string experiment;                  // of lanes without steps, foreign or under a policy: what shows the cause
  bool slow = false;                       // the same: it takes all of its time on other pairs; nothing around is asked

  // The comparison to tell of, the first that decides; null without one, and where the algorithm itself is to blame.
  const Step* told() const { return decisive < 0 ? nullptr : &steps[static_cast<std::size_t>(decisive)]; }
};

struct Explanation {
  Pair pair;
  oracle::Truth truth;
  std::vector<LaneExplanation> lanes;  // the wrong ones, in the given order
  std::vector<const Lane*> outside;    // those of which the pair is not in the contract, and that say otherwise
};

// Explains each of the lanes that is wrong on the pair; CUDA lanes by their twins. Deterministic.
// Requires: lanes that run here, or have a twin. A pair with a coordinate that is not finite has no wrong lanes.
Explanation explain(const Pair& pair, std::span<const Lane* const> lanes);

// The same of each wrong lane, without what lies around the pair: bits_needed, matters, orders, mirrored and scalings
// are not set. A fraction of the time. Lanes that differ by their convention (convention.h) are not wrong.
std::vector<LaneExplanation> accounts(const Pair& pair, Verdict truth, std::span<const Lane* const> lanes);

// The cause that explain gives, without the rest of it: a twentieth of the time, or a third where it says rounding.
// Requires: the lane runs here or has a twin, and is wrong on the pair; truth is the pair's.
Cause cause_of(const Lane& lane, const Pair& pair, Verdict truth);

// Whether a result leaves the scalar's exponents when the lane's source runs without contraction; where none does, the
// cause is neither overflow nor underflow. By the processor's flags, and so quick; may say yes where none does, and
// says no of foreign code, of which it is not known.
bool leaves_exponents(const Lane& lane, const Pair& pair);

// One English sentence on a wrong algorithm, for a bug report; empty when no lane of it is wrong. It names the lanes
// that are wrong alike, with the numbers of one of them.
std::string sentence(const Explanation& explanation, const AlgorithmInfo* subject);

// One sentence for each wrong algorithm, each on a line of its own.
std::vector<std::string> sentences(const Explanation& explanation);

nlohmann::ordered_json to_json(const LaneExplanation& lane);
nlohmann::ordered_json to_json(const Explanation& explanation);

}  // namespace graze::analysis
