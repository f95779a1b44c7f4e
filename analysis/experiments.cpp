// SPDX-License-Identifier: Apache-2.0
#include "analysis/experiments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <optional>
#include <sstream>

#include "analysis/changed_source.h"
#include "analysis/image_experiments.h"
#include "analysis/lane_trace.h"
#include "analysis/scales.h"
#include "backends/backends.h"
#include "core/lanes/verdicts.h"
#include "subjects/rebuilt.h"
#include "subjects/subjects.h"

namespace graze::analysis {
namespace {

// No more verdicts are requested after this many time-outs.
constexpr int kMostLate = 3;

const Lane* in_float64(const Lane& lane) {
  if (lane.scalar == Scalar::f64) return nullptr;
  LaneName other = lane.lane_name();
  other.scalar = name(Scalar::f64);
  const Lane* found = find_lane(id_of(other));
  return found && backends::on_host(*found) ? found : nullptr;
}

// Two neighbouring scales: the lane is wrong at one and right at the other.
struct Turn {
  int wrong, right;
  std::string text() const { return fmt::format("scaled by 2^{} it is right, by 2^{} wrong", right, wrong); }
};

// What scales in range show. right: whether the lane is right at the first one, and so at all if there is no turn.
struct ScaleSearch {
  std::optional<Turn> turn;
  bool right;
  Scales tried;  // the least and the greatest
};

// Whether the code is wrong at all larger scales that were tried, up to 2^most.
struct LargerScales {
  bool wrong;
  int most;
  std::string text() const { return fmt::format("all larger scales that were tried, up to 2^{}", most); }
};

template <class Real>
class Trial {
  using PairOf = BasicPair<Real>;

 public:
  Trial(const Lane& lane, const PairOf& pair, Verdict truth) : lane_(lane), pair_(pair), truth_(truth), size_(pair) {}

  Experiment run(bool unstable) {
    Experiment found = unstable ? cause_of_unstable() : cause();
    found.asked = asked_;
    if (late_ < kMostLate) return found;
    found.settled = false;
    found.slow = true;
    found.evidence += "; on other pairs it gave no answer in time, so not all experiments were made";
    return found;
  }

 private:
  Experiment cause_of_unstable() const {
    if (auto found = by_values(); found && found->settled) return *found;
    return {Cause::unstable, true,
            "it gives another answer when it is asked about the same pair again, or changes the rounding mode"};
  }

  Experiment cause() {
    if (const subjects::Toolchain* toolchain = subjects::toolchain_of(lane_)) {
      if (auto found = by_strict_build(*toolchain)) return *found;
    }
    if (const Lane* rounded = counterpart(lane_, rounded_variant(lane_.variant));
        rounded && rounded != &lane_ && backends::on_host(*rounded)) {
      if (lane_.variant != Variant::toolchain && asked(*rounded, {pair_})[0]) {
        if (info_of(lane_.variant).arithmetic == Arithmetic::fast)
          return by_build(*rounded, Cause::fast_math, "built so that every operation rounds as written it is right");
        return by_build(*rounded, Cause::contraction, "built without contraction it is right");
      }
      source_ = rounded;
    }
    std::optional<Experiment> scale;
    if (!size_.is_zero()) scale = by_scale();
    if (scale && scale->settled) return named(std::move(*scale));
    std::optional<Experiment> number = by_number(scale);
    if (number && number->settled) return *number;
    std::optional<Experiment> values = by_values();
    if (values && values->settled) return *values;
    const Scalar widest = in_float64() ? Scalar::f64 : lane_.scalar;
    if (has_small_integers(pair_, widest)) {
      const std::optional<LargerScales> larger = at_larger_scales();
      if (larger && larger->wrong && !right_in_float64()) {
        if (auto found = without_rounding(pair_, widest, asking())) {
          found->evidence += " and at " + larger->text();
          return *found;
        }
      }
    }
    std::optional<Experiment> precision = scale ? std::nullopt : by_precision();
    if (precision && precision->settled) return *precision;
    if (scale && scale->cause == Cause::absolute_epsilon && subjects::may_have_epsilon(*source_) == false)
      scale->cause = by_exponents_at(last_turn_);
    for (std::optional<Experiment>* found : {&values, &number, &scale, &precision}) {
      if (*found) return open(std::move(**found));
    }
    if (auto both = by_number_in_doubles()) return open(std::move(*both));
    Experiment images = by_images(pair_, asking());
    if (in_float64() && (analysis::in_float64(lane_) || subjects::is_all_in_doubles(*source_))) {
      images.evidence += "; " + in_float64_words() + "it is wrong too";
      if (images.cause == Cause::rounding && holds_determinants(pair_, Scalar::f64)) images.cause = Cause::logic;
    }
    if (images.cause == Cause::logic && !in_float64() && !holds_determinants(pair_, lane_.scalar))
      images.cause = Cause::rounding;  // nothing speaks for either, and determinants of these numbers round
    return open(std::move(images));
  }

  // Code with an epsilon that also rounds too much: neither doubles nor a negligible number alone makes it right.
  std::optional<Experiment> by_number_in_doubles() const {
    const auto number = deciding_number(
        *source_, [this](const DecideBlock& block) -> bool { return asked(block, {pair_})[0]; },
        [](const DecideBlock&) { return true; }, true);
    if (!number) return std::nullopt;
    const std::optional<LargerScales> larger = at_larger_scales(in_float64());
    return Experiment{larger && larger->wrong ? Cause::relative_epsilon : Cause::absolute_epsilon, false,
                      number->words + ", with either alone wrong", number->line};
  }

  // Nothing if no larger scale can be tried.
  std::optional<LargerScales> at_larger_scales() const {
    if (wrong_at_.last >= 1) return LargerScales{true, wrong_at_.last};
    return at_larger_scales(block_of(lane_));
  }
  std::optional<LargerScales> at_larger_scales(const DecideBlock& block) const {
    const Scales usual = scales_in_range(size_, lane_.scalar, kUsualFactors);
    if (size_.is_zero() || usual.last < 1 || !usual.has(0)) return std::nullopt;
    return until(block, usual.last);
  }

  // The same where products may leave the exponents.
  std::optional<LargerScales> at_any_larger_scales() const {
    const Scales all = exact_scales(size_);
    if (size_.is_zero() || all.last < 1) return std::nullopt;
    return until(block_of(lane_), all.last);
  }

  LargerScales until(const DecideBlock& block, int last) const {
    const auto larger = tried(block, {1, last}, 12);
    return {std::none_of(larger.begin(), larger.end(), [](const auto& one) { return one.second; }),
            larger.back().first};
  }

  bool right_in_float64() const {
    const DecideBlock f64 = in_float64();
    return f64 && asked(f64, {pair_})[0];
  }

  // The lane's code in doubles: its own function of doubles, or else its source with double in place of float. Null if
  // there is none.
  DecideBlock in_float64() const {
    if (const Lane* f64 = analysis::in_float64(lane_)) return block_of(*f64);
    if (lane_.scalar == Scalar::f64) return nullptr;
    if (!doubles_) doubles_ = in_doubles(*source_);
    return *doubles_ ? DecideBlock(**doubles_) : nullptr;
  }

  std::string in_float64_words() const {
    return analysis::in_float64(lane_) ? "in float64 " : "with double in place of float ";
  }

  // Adds the number of the source that decides, if it is known.
  Experiment named(Experiment found) const {
    if (found.cause != Cause::absolute_epsilon) return found;
    if (auto number = number_that_decides(); number && number->on_images) {
      found.line = number->line;
      found.evidence += "; " + number->words;
    }
    return found;
  }

  std::optional<Experiment> by_number(const std::optional<Experiment>& scale) const {
    const auto number = number_that_decides();
    if (!number) return std::nullopt;
    const std::optional<LargerScales> larger = at_larger_scales(), any = larger ? larger : at_any_larger_scales();
    const bool relative = !scale && any && any->wrong;
    const bool settled =
        number->on_images && (scale ? scale->cause == Cause::absolute_epsilon && turns_in_range_ : larger.has_value());
    std::string text = number->words;
    if (scale) text += "; " + scale->evidence;
    if (relative) text += "; it is wrong at " + any->text();
    return Experiment{relative ? Cause::relative_epsilon : Cause::absolute_epsilon, settled, std::move(text),
                      settled ? number->line : ""};
  }

  std::optional<Experiment> by_values() const {
    const auto verdict_of = [this](const DecideBlock& block) { return said(block, {&pair_, 1})[0]; };
    auto found = by_initial_values(*source_, truth_, verdict_of);
    if (!found) return std::nullopt;
    const bool settled = found->differ || has_small_integers(pair_, lane_.scalar);
    return Experiment{Cause::uninitialised, settled, std::move(found->words)};
  }

  // Names two experiments that would settle the cause.
  Experiment open(Experiment found) const {
    std::vector<std::string_view> experiments;
    if (!has_small_integers(pair_, lane_.scalar)) experiments.push_back("the pair in small integers (graze minimize)");
    if (lane_.scalar == Scalar::f32 && !in_float64()) experiments.push_back("the same code in doubles");
    if (!subjects::has_source_as_built(lane_)) experiments.push_back("its C++ source, in which Graze changes numbers");
    experiments.push_back("the same code in rational numbers");
    experiments.push_back("its values at each comparison, printed");
    found.evidence += fmt::format("; to settle it, try {} or {}", experiments[0], experiments[1]);
    return found;
  }

  // Whether products of differences stay within the exponents, as far as that can be known. Overflow is checked for the
  // longest products; underflow only for the usual ones, whose factors may all be small.
  bool has_usual_exponents() const {
    return kUsualFactors * size_.smallest_difference >= limits().least &&
           kMostFactors * (size_.largest_difference + 1) < limits().most;
  }

  // Code that is wrong in exact arithmetic may be right on this pair by luck. Float64 or another scale reveals that.
  // The lane of the same code and compiler in which every operation rounds, as OpenCL has one; null if there is none.
  const Lane* rounded_sibling(const subjects::Toolchain& toolchain) const {
    for (const Lane& lane : lanes()) {
      if (lane.info != lane_.info || lane.scalar != lane_.scalar || !lane.decide) continue;
      const subjects::Toolchain* other = subjects::toolchain_of(lane);
      if (other && other->cxx == toolchain.cxx && other->rounding == subjects::Rounding::rounded) return &lane;
    }
    return nullptr;
  }

  // The toolchain's build with its strict flags; nothing if there is none, or if that is wrong too.
  std::optional<Experiment> by_strict_build(const subjects::Toolchain& toolchain) const {
    constexpr Cause kCauses[] = {Cause::contraction, Cause::contraction, Cause::excess_precision, Cause::fast_math};
    const Cause cause = kCauses[static_cast<int>(toolchain.rounding)];
    if (toolchain.strict.empty()) {
      const Lane* rounded = rounded_sibling(toolchain);
      if (!rounded || !asked(*rounded, {pair_})[0]) return std::nullopt;
      const bool opencl = rounded->toolchain == "opencl-nofma";
      return by_build(*rounded, cause,
                      fmt::format("built as {} it is right{}", rounded->toolchain,
                                  opencl ? ": #pragma OPENCL FP_CONTRACT OFF" : ""));
    }
    std::istringstream words(toolchain.strict);
    const std::vector<std::string> flags{std::istream_iterator<std::string>(words), {}};
    const subjects::ChangedCode strict = subjects::changed(lane_, {.flags = flags});
    if (!strict || !asked(*strict, {pair_})[0]) return std::nullopt;
    Experiment found = by_build(*strict, analysis::in_float64(lane_), cause,
                                fmt::format("compiled with {} it is right", toolchain.strict));
    if (cause != Cause::contraction) return found;
    for (const subjects::FusedLine& line : subjects::fused_lines_of(lane_)) {
      const subjects::ChangedCode rounded = subjects::changed(lane_, {.rounded = line});
      if (!rounded || !asked(*rounded, {pair_})[0]) continue;
      found.line = line.place();
      break;
    }
    return found;
  }

  Experiment by_build(const Lane& rounded, Cause cause, std::string evidence) const {
    return by_build(block_of(rounded), analysis::in_float64(rounded), cause, std::move(evidence));
  }
  Experiment by_build(const DecideBlock& rounded, const Lane* f64, Cause cause, std::string evidence) const {
    if (f64 && !asked(*f64, {pair_})[0]) return {cause, false, evidence + ", but that build is wrong in float64"};
    if (size_.is_zero() || has_small_integers(pair_, lane_.scalar))
      return {cause, false, evidence + ", though only roots and quotients round here"};
    const Scales scales = scales_in_range(size_, lane_.scalar, kUsualFactors);
    for (const auto& [k, right] : tried(rounded, scales, 16)) {
      if (!right) return {cause, false, evidence + fmt::format(", but that build is wrong when scaled by 2^{}", k)};
    }
    return {cause, true, std::move(evidence)};
  }

  std::vector<Verdict> said(const DecideBlock& block, std::span<const PairOf> pairs) const {
    asked_ += static_cast<int>(pairs.size());
    std::vector<Verdict> verdicts = verdicts_of(block, pairs);
    late_ += static_cast<int>(std::count(verdicts.begin(), verdicts.end(), Verdict::timed_out));
    return verdicts;
  }

  // For each pair, whether the block is right. Pairs that were not tried, because others took all of their time, are
  // false; until_wrong: so are those after a wrong one.
  std::vector<bool> asked(const DecideBlock& block, const std::vector<PairOf>& pairs, bool until_wrong = false) const {
    constexpr std::size_t kAtOnce = foreign_at_once(false);
    std::vector<bool> right(pairs.size());
    for (std::size_t begin = 0; begin < pairs.size() && late_ < kMostLate; begin += kAtOnce) {
      const std::vector<Verdict> verdicts =
          said(block, std::span(pairs).subspan(begin, std::min(kAtOnce, pairs.size() - begin)));
      std::transform(verdicts.begin(), verdicts.end(), right.begin() + static_cast<std::ptrdiff_t>(begin),
                     [this](Verdict verdict) { return verdict == truth_; });
      if (until_wrong && std::any_of(verdicts.begin(), verdicts.end(), [this](Verdict v) { return v != truth_; }))
        break;
    }
    return right;
  }
  std::vector<bool> asked(const Lane& lane, const std::vector<PairOf>& pairs) const {
    return asked(block_of(lane), pairs);
  }

  std::optional<DecidingNumber> number_that_decides() const {
    return deciding_number(
        *source_, [this](const DecideBlock& block) -> bool { return asked(block, {pair_})[0]; },
        [this](const DecideBlock& block) {
          if (!wrong_images_) wrong_images_ = wrong_images(pair_, asking());
          const std::vector<bool> right = asked(block, *wrong_images_, true);
          return !right.empty() && std::all_of(right.begin(), right.end(), std::identity());
        });
  }

  Ask<Real> asking() const {
    return [this](const std::vector<PairOf>& pairs) { return asked(lane_, pairs); };
  }

  const ScalarLimits& limits() const { return limits_of(lane_.scalar); }

  // Tries at most `most` evenly spaced scales. Returns each scale and whether the lane is right there.
  std::vector<std::pair<int, bool>> tried(const Lane& lane, Scales scales, int most) const {
    return tried(block_of(lane), scales, most);
  }
  std::vector<std::pair<int, bool>> tried(const DecideBlock& block, Scales scales, int most) const {
    std::vector<std::pair<int, bool>> result;
    if (scales.empty()) return result;
    const int step = std::max(1, (scales.last - scales.first) / most + 1);
    std::vector<PairOf> pairs;
    for (int k = scales.first; k <= scales.last; k += step) {
      result.emplace_back(k, false);
      pairs.push_back(scaled(pair_, k));
    }
    const std::vector<bool> right = asked(block, pairs);
    for (std::size_t i = 0; i < right.size(); ++i) result[i].second = right[i];
    return result;
  }

  // Finds a turn between these two scales.   Requires: the lane is wrong at the first and right at the second.
  Turn bisected(int wrong, int right) const {
    while (std::abs(right - wrong) > 1) {
      const int middle = wrong + (right - wrong) / 2;
      (asked(lane_, {scaled(pair_, middle)})[0] ? right : wrong) = middle;
    }
    return last_turn_ = {wrong, right};
  }

  // Whether the same code in float64 is right wherever no product leaves its exponents.
  bool right_in_float64_at_every_scale() const {
    const DecideBlock f64 = in_float64();
    if (!f64) return false;
    const Scales scales = scales_in_range(size_, Scalar::f64, kMostFactors);
    const auto all = tried(f64, scales, 24);
    return scales.has(0) && std::all_of(all.begin(), all.end(), [](const auto& one) { return one.second; });
  }

  // Finds two neighbouring scales in range such that the lane is right at one of them only. Prefers a turn at which the
  // larger scale is right.
  ScaleSearch turn_within(Scales in_range, int most) const {
    auto inside = tried(lane_, in_range, most);
    const std::pair own{0, false};
    if (in_range.has(0)) inside.insert(std::lower_bound(inside.begin(), inside.end(), own), own);
    ScaleSearch search{std::nullopt, inside[0].second, {inside.front().first, inside.back().first}};
    for (const bool upwards : {true, false}) {
      for (std::size_t i = inside.size() - 1; i > 0; --i) {
        const auto [k, right] = inside[i];
        if (right != upwards || inside[i - 1].second == upwards) continue;
        search.turn = upwards ? bisected(inside[i - 1].first, k) : bisected(k, inside[i - 1].first);
        return search;
      }
    }
    return search;
  }

  // Whether the lane is right at all scales above the turn and wrong at all below. Code that adds numbers of different
  // units, such as lengths and areas, becomes wrong again at other scales. Code with a small epsilon does not.
  bool turns_once(Turn turn) const {
    if (turn.right < turn.wrong) return false;
    auto near = tried(lane_, common(strictly_, {turn.wrong - 12, turn.right + 12}), 26);
    const auto far = tried(lane_, strictly_, 32);
    near.insert(near.end(), far.begin(), far.end());
    return std::all_of(near.begin(), near.end(),
                       [&](const auto& one) { return one.second == (one.first >= turn.right); });
  }

  std::optional<Experiment> by_scale() {
    strictly_ = scales_in_range(size_, lane_.scalar, kMostFactors);
    if (!strictly_.empty()) {
      if (const auto turn = turn_within(strictly_, 16).turn) {
        turns_in_range_ = true;
        std::string text = fmt::format(
            "{}, and no product of up to {} coordinates leaves the exponents of {} at these "
            "scales",
            turn->text(), kMostFactors, limits().name);
        const bool once = turns_once(*turn);
        if (!once) text += "; but its verdict changes at other scales too";
        return Experiment{Cause::absolute_epsilon, once, std::move(text)};
      }
    }
    const Scales in_range = scales_in_range(size_, lane_.scalar, kUsualFactors);
    if (in_range.empty()) return by_any_scale();
    const auto [turn, right, tried] = turn_within(in_range, 32);
    if (turn) {
      turns_in_range_ = true;
      if (!right_in_float64_at_every_scale()) return Experiment{Cause::absolute_epsilon, false, turn->text()};
      const Cause cause = by_exponents_at(*turn);
      return Experiment{cause, false,
                        turn->text() + (cause == Cause::rounding ? ", in float64 at all that were tried" : "")};
    }
    if (right) return outside(bisected(0, in_range.first > 0 ? in_range.first : in_range.last));
    wrong_at_ = tried;
    return beyond(in_range);
  }

  // Underflow or overflow if some product of coordinates can have that where the lane is wrong; else rounding.
  Cause by_exponents_at(Turn turn) const {
    const bool upwards = turn.right > turn.wrong;
    const bool leaves = upwards ? kMostFactors * (size_.smallest_difference + turn.wrong) < limits().least
                                : kMostFactors * (size_.largest_difference + 1 + turn.wrong) >= limits().most;
    return !leaves ? Cause::rounding : upwards ? Cause::underflow : Cause::overflow;
  }

  // The lane is right at all scales in range, so the pair is out of range. The lane turns wrong between the range and
  // the pair.
  Experiment outside(Turn turn) const {
    // In doubles nothing wider can show that code which adds lengths and areas is not wrong here without limits too.
    constexpr bool kIsNarrow = sizeof(Real) == sizeof(float);
    const bool by_float64 = right_in_float64_at_every_scale();
    const std::string text = turn.text(),
                      doubles = by_float64 ? ", and in float64 it is right at all scales that were tried" : "";
    if (turn.right > turn.wrong) {
      if (!by_float64 && kUsualFactors * (size_.smallest_difference + turn.wrong) >= limits().least)
        return {Cause::absolute_epsilon, false,
                text + fmt::format(", though products of its differences are not too small for {}", limits().name)};
      const bool lost = 3 * (size_.largest_difference + 1 + turn.wrong) <= limits().least;
      return {Cause::underflow, (kIsNarrow && lost) || (by_float64 && !strictly_.empty()),
              lost ? text + fmt::format(", where every product of three differences is too small for {}", limits().name)
                   : text + doubles};
    }
    const auto too_large = [&](int factors) {
      return factors * (size_.largest_difference + turn.wrong) >= limits().most;
    };
    const bool lost = too_large(3);
    if (!by_float64 && !too_large(4))
      return {Cause::absolute_epsilon, false,
              text + fmt::format(", though products of four differences are not too large for {}", limits().name)};
    return {Cause::overflow, (kIsNarrow && lost) || (by_float64 && too_large(4)),
            lost ? text + fmt::format(", where products of three differences are too large for {}", limits().name)
                 : text + doubles};
  }

  // For pairs that have no scale at which every product stays within the exponents.
  std::optional<Experiment> by_any_scale() const {
    const Scales all = exact_scales(size_);
    const auto up = tried(lane_, {1, all.last}, 24), down = tried(lane_, {all.first, -1}, 24);
    const auto is_right = [](const auto& one) { return one.second; };
    const auto above = std::find_if(up.begin(), up.end(), is_right);
    const auto below = std::find_if(down.rbegin(), down.rend(), is_right);
    if (above == up.end() && below == down.rend()) return std::nullopt;
    const bool upwards = below == down.rend() || (above != up.end() && above->first <= -below->first);
    const Turn turn = bisected(0, upwards ? above->first : below->first);
    const bool leaves = upwards ? kUsualFactors * (size_.smallest_difference + turn.wrong) < limits().least
                                : 4 * (size_.largest_difference + turn.wrong) >= limits().most;
    const Cause by_exponents = upwards ? Cause::underflow : Cause::overflow;
    return Experiment{leaves || right_in_float64_at_every_scale() ? by_exponents : Cause::absolute_epsilon, false,
                      turn.text()};
  }

  // The lane is wrong at all scales in range. It may turn right some way above, where only longer products can
  // overflow.
  std::optional<Experiment> beyond(Scales in_range) const {
    const Scales more{in_range.last + 1, scales_in_range(size_, lane_.scalar, kUsualFactors / 2).last};
    const auto up = tried(lane_, more, 12);
    const auto right = std::find_if(up.begin(), up.end(), [](const auto& one) { return one.second; });
    if (right == up.end() || right_in_float64()) return std::nullopt;
    return Experiment{Cause::absolute_epsilon, false, bisected(in_range.last, right->first).text()};
  }

  std::optional<Experiment> by_precision() const {
    if (!right_in_float64()) return std::nullopt;
    // If sums and products are exact here, it may be right by luck.
    const Lane* f64 = analysis::in_float64(lane_);
    const Lane* rounded = f64 ? counterpart(*f64, rounded_variant(f64->variant)) : nullptr;
    const bool as_written = !rounded || !backends::on_host(*rounded) || asked(*rounded, {pair_})[0];
    if (wrong_at_.empty() || !has_usual_exponents() || has_small_integers(pair_, lane_.scalar) || !as_written ||
        !right_in_float64_at_every_scale())
      return Experiment{Cause::rounding, false, in_float64_words() + "it is right"};
    return Experiment{Cause::rounding, true,
                      in_float64_words() + fmt::format("it is right, in float32 wrong at all scales that were tried, "
                                                       "2^{} to 2^{}",
                                                       wrong_at_.first, wrong_at_.last)};
  }

  const Lane& lane_;
  const Lane* source_ = &lane_;  // the same code rounded as written if that is wrong too: its source is changed
  const PairOf& pair_;
  Verdict truth_;
  Size size_;
  mutable int asked_ = 0, late_ = 0;                         // verdicts; those that took all of their time
  mutable std::optional<std::vector<PairOf>> wrong_images_;  // once asked for
  mutable std::optional<subjects::ChangedCode> doubles_;
  Scales strictly_{1, 0};  // scales at which even the longest products stay within the exponents
  mutable Turn last_turn_{0, 0};
  bool turns_in_range_ = false;  // the verdict turns between two of these
  Scales wrong_at_{1, 0};        // wrong at all scales tried from first to last, those at which the usual products stay
                                 // within the exponents; none if it is right at some
};

}  // namespace

template <class Real>
Experiment experiment(const Lane& lane, Verdict verdict, const BasicPair<Real>& pair, Verdict truth) {
  const subjects::Opened* code = subjects::opened(lane.info->id);
  switch (verdict) {
    case Verdict::crashed:
      return {
          Cause::crash, true,
          code && code->kind == "command" ? "its process ended, or its line was not 1, 0 or ?" : "its process ended"};
    case Verdict::timed_out:
      return {Cause::no_answer, true, "it exceeded its time limit"};
    default:
      return Trial<Real>(lane, pair, truth).run(verdict == Verdict::unstable);
  }
}

template Experiment experiment(const Lane&, Verdict, const Pair&, Verdict);
template Experiment experiment(const Lane&, Verdict, const DoublePair&, Verdict);

}  // namespace graze::analysis
