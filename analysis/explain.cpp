// SPDX-License-Identifier: Apache-2.0
#include "analysis/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <limits>
#include <map>

namespace graze::analysis {
namespace {

#pragma GCC diagnostic push
#pragma GCC diagnostic error "-Wswitch"  // a new site needs its name here
std::string_view name_of(Site site) {
  switch (site) {
    case Site::plane_distance:
      return "plane_distance";
    case Site::parallel:
      return "parallel";
    case Site::orientation:
      return "orientation";
    case Site::separation:
      return "separation";
  }
  return "";
}
#pragma GCC diagnostic pop

constexpr std::string_view kRelations[] = {"<", "<=", "==", ">", ">="};

// "core/vec3.h:46", wherever the compiler found the file.
std::string line_of(const std::source_location& where) {
  const std::string_view file = where.file_name();
  const std::size_t folder = file.rfind("core/");
  return fmt::format("{}:{}", folder == std::string_view::npos ? file : file.substr(folder), where.line());
}

// What all lanes of an algorithm share.
struct Algorithm {
  oracle::Exactly exactly;
  int bits_needed_f32, bits_needed_f64;
};

// Where roots or quotients leave a tie open in every precision, the verdict may be right with some numbers of bits and
// wrong with others, without end. There, a number of bits is called enough only when it is less than half of kMostBits.
Algorithm study(int algorithm, const Pair& pair, Verdict truth) {
  const oracle::Exactly exactly = oracle::decide_exactly(algorithm, pair);
  int bits = exactly.verdict == truth ? oracle::bits_needed(algorithm, pair, truth, 24) : 0;
  if (!exactly.certain && bits > oracle::kMostBits / 2) bits = 0;
  return {exactly, bits, bits == 0 ? 0 : std::max(bits, 53)};
}

// The pairs beside the pair, and the truth of those whose truth is another question.
struct Neighbours {
  std::vector<Pair> orders, mirrored, scalings;
  std::array<std::vector<Pair>, kCoordinates> nudged;
  std::array<bool, kCoordinates> truth_stays;

  Neighbours(const Pair& pair, Verdict truth)
      : orders(analysis::orders(pair)), mirrored(analysis::mirrored(pair)), scalings(analysis::scalings(pair)) {
    for (std::size_t c = 0; c < kCoordinates; ++c) {
      nudged[c] = analysis::nudged(pair, static_cast<int>(c));
      truth_stays[c] = std::all_of(nudged[c].begin(), nudged[c].end(),
                                   [truth](const Pair& moved) { return oracle::cgal_verdict(moved) == truth; });
    }
  }
};

WrongOf wrong_of(const Lane& lane, const std::vector<Pair>& pairs, Verdict truth) {
  const auto wrong =
      std::count_if(pairs.begin(), pairs.end(), [&](const Pair& pair) { return decide_lane(lane, pair) != truth; });
  return {static_cast<int>(wrong), static_cast<int>(pairs.size())};
}

// The same source on the same kind of processor, with every operation rounded as written.
const Lane& rounded_counterpart(const Lane& lane) { return *counterpart(lane, rounded_variant(lane.variant)); }

Cause first_cause(const Lane& lane, const Pair& pair, Verdict truth, const oracle::Exactly& exactly) {
  if (exactly.verdict != truth) return Cause::logic;
  if (decide_lane(rounded_counterpart(lane), pair) == truth)
    return info_of(lane.variant).arithmetic == Arithmetic::fast ? Cause::fast_math : Cause::contraction;
  const auto limited = [&](bool upper, bool lower) {
    return oracle::decide_limited(lane.algorithm, lane.scalar, pair, {upper, lower});
  };
  if (limited(false, false).verdict != truth) return Cause::rounding;
  const bool overflow = limited(true, false).verdict != truth, underflow = limited(false, true).verdict != truth;
  if (overflow != underflow) return overflow ? Cause::overflow : Cause::underflow;
  return limited(true, true).first == oracle::RangeEvent::overflow ? Cause::overflow : Cause::underflow;
}

// Where more bits and wider exponents are both needed, the comparison that went wrong tells which failed first: when a
// value is not a number any more, or is lost because it is less than the least normal number, rounding is not to blame.
Cause refined(const LaneExplanation& lane, const Pair& pair) {
  const Step* told = lane.told();
  if (lane.cause != Cause::rounding || !told) return lane.cause;
  const oracle::RangeEvent first =
      oracle::decide_limited(lane.lane->algorithm, lane.lane->scalar, pair, {true, true}).first;
  const double least =
      lane.lane->scalar == Scalar::f32 ? double{std::numeric_limits<float>::min()} : std::numeric_limits<double>::min();
  const oracle::Beside& difference = told->difference;
  const bool lost = difference.lane == 0 && difference.decimal != "0" && std::abs(difference.exact) < least;
  if (first == oracle::RangeEvent::none || (std::isfinite(difference.lane) && !lost)) return Cause::rounding;
  return first == oracle::RangeEvent::overflow && !lost ? Cause::overflow : Cause::underflow;
}

// The path up to a comparison, which goes the other way.
Path turned_at(const Path& path, std::size_t comparison) {
  Path turned(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(comparison) + 1);
  turned[comparison] = !turned[comparison];
  return turned;
}

void add_steps(LaneExplanation& result, const Pair& pair, Verdict truth, const oracle::Exactly& exactly) {
  const Lane& lane = *result.lane;
  const Replay run = replay(lane, pair);
  result.evidence = run.evidence;
  if (run.evidence == Evidence::none) return;
  const std::vector<oracle::ExactStep> exact =
      oracle::exact_steps(lane.algorithm, lane.scalar, pair, run.run, exactly.bits);
  const Path path = path_of(run.run);
  std::size_t comparison = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const Seen<double>& seen = run.run.seen[i];
    const bool wrong = seen.compared && seen.held != exact[i].held;
    if (seen.site || wrong) {
      const int place = static_cast<int>(result.steps.size());
      result.steps.push_back({line_of(seen.where), seen.site ? name_of(*seen.site) : "",
                              seen.compared ? kRelations[static_cast<int>(seen.relation)] : "", exact[i].left,
                              exact[i].right, exact[i].difference, seen.held, exact[i].held});
      if (wrong && result.first_wrong < 0) result.first_wrong = place;
      if (wrong && result.decisive < 0 && run_led(lane, pair, run.rule, turned_at(path, comparison)).verdict == truth)
        result.decisive = place;
    }
    comparison += seen.compared;
  }
}

LaneExplanation explain_lane(const Lane& lane, Verdict verdict, const Pair& pair, Verdict truth,
                             const Algorithm& algorithm, const Neighbours& neighbours) {
  LaneExplanation result{
      .lane = &lane,
      .verdict = verdict,
      .cause = first_cause(lane, pair, truth, algorithm.exactly),
      .exactly = algorithm.exactly,
      .evidence = Evidence::none,
      .steps = {},
      .contractions = {},
      .bits_needed = lane.scalar == Scalar::f32 ? algorithm.bits_needed_f32 : algorithm.bits_needed_f64,
      .matters = {},
      .orders = wrong_of(lane, neighbours.orders, truth),
      .mirrored = wrong_of(lane, neighbours.mirrored, truth),
      .scalings = wrong_of(lane, neighbours.scalings, truth)};
  add_steps(result, pair, truth, algorithm.exactly);
  result.cause = refined(result, pair);
  if (!cuda::contraction_sites(lane).empty()) result.contractions = blame(lane, pair);
  for (std::size_t c = 0; c < kCoordinates; ++c) {
    const std::vector<Pair>& nudged = neighbours.nudged[c];
    result.matters[c] =
        !neighbours.truth_stays[c] || wrong_of(lane, nudged, truth).wrong < static_cast<int>(nudged.size());
  }
  return result;
}

}  // namespace

Cause cause_of(const Lane& lane, const Pair& pair, Verdict truth) {
  LaneExplanation result{};
  result.lane = &lane;
  result.exactly = oracle::decide_exactly(lane.algorithm, pair);
  result.cause = first_cause(lane, pair, truth, result.exactly);
  // The steps can only tell of a rounding that the range had a part in it.
  if (result.cause != Cause::rounding || !leaves_exponents(lane, pair)) return result.cause;
  add_steps(result, pair, truth, result.exactly);
  return refined(result, pair);
}

bool leaves_exponents(const Lane& lane, const Pair& pair) {
  const DecideBlock block = block_of(rounded_counterpart(lane));
  std::uint64_t intersects, declined;
  std::feclearexcept(FE_OVERFLOW | FE_UNDERFLOW);
  block(&pair, 1, &intersects, &declined);
  return std::fetestexcept(FE_OVERFLOW | FE_UNDERFLOW) != 0;
}

std::string_view name(Cause cause) {
  constexpr std::string_view kNames[] = {"rounding", "contraction", "fast math", "overflow", "underflow", "logic"};
  return kNames[static_cast<int>(cause)];
}

Explanation explain(const Pair& pair, std::span<const Lane* const> lanes) {
  Explanation result{pair, oracle::truth(pair), {}};
  const Verdict right = result.truth.verdict;
  if (right == Verdict::declined) return result;
  std::map<const AlgorithmInfo*, Algorithm> algorithms;
  std::optional<Neighbours> neighbours;
  for (const Lane* lane : lanes) {
    if (lane->exact) continue;
    const Verdict verdict = decide_lane(*lane, pair);
    if (verdict == right) continue;
    if (!neighbours) neighbours.emplace(pair, right);
    auto found = algorithms.find(lane->info);
    if (found == algorithms.end()) {
      found = algorithms.emplace(lane->info, study(lane->algorithm, pair, right)).first;
    }
    result.lanes.push_back(explain_lane(*lane, verdict, pair, right, found->second, *neighbours));
  }
  return result;
}

}  // namespace graze::analysis
