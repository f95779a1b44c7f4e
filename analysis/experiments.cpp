// SPDX-License-Identifier: Apache-2.0
#include "analysis/experiments.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <sstream>
#include <tuple>

#include "analysis/changed_source.h"
#include "analysis/image_experiments.h"
#include "analysis/image_verdicts.h"
#include "analysis/lane_trace.h"
#include "analysis/scales.h"
#include "backends/backends.h"
#include "core/lanes/verdicts.h"
#include "subjects/rebuilt.h"
#include "subjects/subjects.h"

namespace graze::analysis {
namespace {

constexpr char kSelects[] = ", but its source may select other code in that build";

template <class Real>
class Trial {
  using PairOf = BasicPair<Real>;

 public:
  Trial(const Lane& lane, const PairOf& pair, Verdict truth)
      : lane_(lane), pair_(pair), truth_(truth), size_(pair), ask_(lane, pair, truth) {}

  Experiment run(bool unstable) {
    Experiment found = unstable ? cause_of_unstable() : cause();
    found.asked = ask_.verdicts();
    if (ask_.declined_some()) {
      found.settled = false;
      found.evidence += "; it declines some of the pairs that were tried, which count as wrong here";
    }
    if (!ask_.gave_up()) return found;
    found.settled = false;
    found.slow = true;
    found.evidence += "; on other pairs it gave no answer in time, so not all experiments were made";
    return found;
  }

 private:
  Experiment cause_of_unstable() const {
    if (auto found = by_values(); found && found->settled) return *found;
    return {Cause::unstable, true,
            "it gives different answers for the same pair, or changes how the processor rounds or treats subnormal "
            "numbers"};
  }

  Experiment cause() {
    if (const subjects::Toolchain* toolchain = subjects::toolchain_of(lane_)) {
      if (auto found = by_strict_build(*toolchain)) return *found;
    }
    if (const Lane* rounded = counterpart(lane_, rounded_variant(lane_.variant));
        rounded && rounded != &lane_ && backends::on_host(*rounded)) {
      if (lane_.variant != Variant::toolchain && ask_.asked(*rounded, {pair_})[0]) {
        if (info_of(lane_.variant).arithmetic == Arithmetic::fast)
          return by_build(*rounded, Cause::fast_math, "built so that every operation rounds as written it is right");
        return by_build(*rounded, Cause::contraction, "built without contraction it is right");
      }
    }
    std::optional<Experiment> scale;
    if (!size_.is_zero()) scale = by_scale();
    if (scale && scale->settled) return named(std::move(*scale));
    std::optional<Experiment> number = by_number(scale);
    if (number && number->settled) return *number;
    std::optional<Experiment> values = by_values();
    if (values && values->settled) return *values;
    const Scalar widest = ask_.in_float64() ? Scalar::f64 : lane_.scalar;
    if (has_small_integers(pair_, widest)) {
      const std::optional<LargerScales> larger = at_larger_scales();
      if (larger && larger->wrong && !ask_.right_in_float64()) {
        if (auto found = without_rounding(pair_, widest, asking())) {
          found->evidence += " and at " + larger->text();
          return *found;
        }
      }
    }
    std::optional<Experiment> precision = scale ? std::nullopt : by_precision();
    if (precision && precision->settled && !perhaps_vanishes_) return *precision;
    if (scale && scale->cause == Cause::absolute_epsilon && subjects::may_have_epsilon(lane_) == false)
      scale->cause = by_exponents_at(ask_.last_turn());
    for (std::optional<Experiment>* found : {&values, &number, &scale, &precision}) {
      if (*found) return open(std::move(**found));
    }
    if (auto both = by_number_in_doubles()) return open(std::move(*both));
    Experiment images = by_images(pair_, asking());
    if (ask_.in_float64() && (analysis::in_float64(lane_) || subjects::is_all_in_doubles(lane_))) {
      images.evidence += "; " + ask_.in_float64_words() + "it is wrong too";
      if (images.cause == Cause::rounding && holds_determinants(pair_, Scalar::f64)) images.cause = Cause::logic;
    }
    if (images.cause == Cause::logic && !ask_.in_float64() && !holds_determinants(pair_, lane_.scalar))
      images.cause = Cause::rounding;  // nothing tells logic from rounding, and determinants of these numbers round
    return open(std::move(images));
  }

  // Finds code that has an epsilon and also rounds too much: it is right only with doubles and a negligible number.
  std::optional<Experiment> by_number_in_doubles() const {
    const auto number = deciding_number(
        lane_, [this](const DecideBlock& block) -> bool { return ask_.asked(block, {pair_})[0]; },
        [](const DecideBlock&) { return true; }, true);
    if (!number) return std::nullopt;
    const std::optional<LargerScales> larger = at_larger_scales(ask_.in_float64());
    return Experiment{larger && larger->wrong ? Cause::relative_epsilon : Cause::absolute_epsilon, false,
                      number->words + ", with either alone wrong", number->line};
  }

  // Returns nothing if no larger scale can be tried.
  std::optional<LargerScales> at_larger_scales() const {
    if (wrong_at_.last >= 1) return LargerScales{true, wrong_at_.last};
    return at_larger_scales(block_of(lane_));
  }
  std::optional<LargerScales> at_larger_scales(const DecideBlock& block) const {
    const Scales usual = scales_in_range(size_, lane_.scalar, kUsualFactors);
    if (size_.is_zero() || usual.last < 1 || !usual.has(0)) return std::nullopt;
    return ask_.until(block, usual.last);
  }

  // Like at_larger_scales, but products may leave the exponent range.
  std::optional<LargerScales> at_any_larger_scales() const {
    const Scales all = exact_scales(size_);
    if (size_.is_zero() || all.last < 1) return std::nullopt;
    return ask_.until(block_of(lane_), all.last);
  }

  // The least exponent of these scales, of which `most` are tried, at which the code is right; 0 if none is found.
  int right_among(Scales scales, int most) const {
    for (const auto& [scale, right] : ask_.tried(lane_, scales, most)) {
      if (right) return scale;
    }
    return 0;
  }

  // The exponent of a scale below the pair's own at which the code is right, one of these if possible; 0 if none is
  // found.
  int right_below(Scales usual) const {
    const int found = right_among({usual.first, -1}, 12);
    return found != 0 ? found : right_among({exact_scales(size_).first, -1}, 12);
  }

  // Adds the number in the source that decides the verdict, if it is known.
  Experiment named(Experiment found) const {
    if (found.cause != Cause::absolute_epsilon) return found;
    if (auto number = number_that_decides(); number && number->on_images) {
      found.line = number->line;
      found.evidence += "; " + number->words;
    }
    return found;
  }

  std::optional<Experiment> by_number(const std::optional<Experiment>& scale) {
    const auto number = number_that_decides();
    if (!number) return std::nullopt;
    const std::optional<LargerScales> larger = at_larger_scales(), any = larger ? larger : at_any_larger_scales();
    const bool wrong_above = !scale && any && any->wrong;
    const Scales usual = scales_in_range(size_, lane_.scalar, kUsualFactors);
    const int below = wrong_above ? right_below(usual) : 0;
    // Beyond the usual scales, an epsilon may be negligible, or products that overflow may make the code right.
    const int above = wrong_above ? right_among({1, exact_scales(size_).last}, 64) : 0;
    perhaps_vanishes_ = above != 0 && number->on_images;
    const bool in_range = below < 0 && usual.has(0) && usual.has(below),
               relative = wrong_above && above == 0 && !in_range;
    // An absolute epsilon becomes negligible at large scales, so the code must be right there.
    const bool settled =
        number->on_images && below == 0 && above == 0 &&
        (scale ? scale->cause == Cause::absolute_epsilon && turns_in_range_ && ask_.last_turn().upwards()
               : larger.has_value());
    std::string text = number->words;
    if (scale) text += "; " + scale->evidence;
    if (wrong_above) text += "; it is wrong at " + any->text();
    for (const int right : {above, below}) {
      if (right != 0) text += fmt::format(", but right at 2^{}", right);
    }
    return Experiment{relative ? Cause::relative_epsilon : Cause::absolute_epsilon, settled, std::move(text),
                      settled ? number->line : ""};
  }

  std::optional<Experiment> by_values() const {
    const auto verdict_of = [this](const DecideBlock& block) { return ask_.said(block, {&pair_, 1})[0]; };
    auto found = by_initial_values(lane_, truth_, verdict_of);
    if (!found) return std::nullopt;
    const bool settled = found->differ || has_small_integers(pair_, lane_.scalar);
    return Experiment{Cause::uninitialised, settled, std::move(found->words)};
  }

  // Names two experiments that would settle the cause.
  Experiment open(Experiment found) const {
    std::vector<std::string_view> experiments;
    if (!has_small_integers(pair_, lane_.scalar)) experiments.push_back("the pair in small integers (graze minimize)");
    if (lane_.scalar == Scalar::f32 && !ask_.in_float64()) experiments.push_back("the same code in doubles");
    if (!subjects::has_source_as_built(lane_)) experiments.push_back("its C++ source, in which Graze changes numbers");
    experiments.push_back("the same code in rational numbers");
    experiments.push_back("its values at each comparison, printed");
    found.evidence += fmt::format("; to settle it, try {} or {}", experiments[0], experiments[1]);
    return found;
  }

  // Whether products of differences stay in the exponent range, as far as that can be known. Overflow is checked for
  // the longest products; underflow is checked only for the usual products, whose factors may all be small.
  bool has_usual_exponents() const {
    return kUsualFactors * size_.smallest_difference >= limits().least &&
           kMostFactors * (size_.largest_difference + 1) < limits().most;
  }

  // The lane with the same code and compiler that rounds every operation; OpenCL has one. Null if there is none.
  const Lane* rounded_sibling(const subjects::Toolchain& toolchain) const {
    for (const Lane& lane : lanes()) {
      if (lane.info != lane_.info || lane.scalar != lane_.scalar || !lane.decide) continue;
      const subjects::Toolchain* other = subjects::toolchain_of(lane);
      if (other && other->cxx == toolchain.cxx && other->rounding == subjects::Rounding::rounded) return &lane;
    }
    return nullptr;
  }

  // Tries the toolchain's build with strict flags. Returns nothing if there is no such build, or if its verdict is
  // wrong too.
  std::optional<Experiment> by_strict_build(const subjects::Toolchain& toolchain) const {
    constexpr Cause kCauses[] = {Cause::contraction, Cause::contraction, Cause::excess_precision, Cause::fast_math};
    const Cause cause = kCauses[static_cast<int>(toolchain.rounding)];
    if (toolchain.strict.empty()) {
      const Lane* rounded = rounded_sibling(toolchain);
      if (!rounded || !ask_.asked(*rounded, {pair_})[0]) return std::nullopt;
      const bool opencl = rounded->toolchain == "opencl-nofma";
      return by_build(*rounded, cause,
                      fmt::format("built as {} it is right{}", rounded->toolchain,
                                  opencl ? ": #pragma OPENCL FP_CONTRACT OFF" : ""));
    }
    std::istringstream words(toolchain.strict);
    const std::vector<std::string> flags{std::istream_iterator<std::string>(words), {}};
    const subjects::ChangedCode strict = subjects::changed(lane_, {.flags = flags});
    if (!strict || !ask_.asked(*strict, {pair_})[0]) return std::nullopt;
    Experiment found = by_build(*strict, analysis::in_float64(lane_), cause,
                                fmt::format("compiled with {} it is right", toolchain.strict));
    if (cause != Cause::contraction) return found;
    for (const subjects::FusedLine& line : subjects::fused_lines_of(lane_)) {
      const subjects::ChangedCode rounded = subjects::changed(lane_, {.rounded = line});
      if (!rounded || !ask_.asked(*rounded, {pair_})[0]) continue;
      found.line = line.place();
      break;
    }
    return found;
  }

  // Code that is wrong in exact arithmetic may be right on this pair by luck; float64 or another scale reveals it.
  Experiment by_build(const Lane& rounded, Cause cause, std::string evidence) const {
    return by_build(block_of(rounded), analysis::in_float64(rounded), cause, std::move(evidence));
  }
  Experiment by_build(const DecideBlock& rounded, const Lane* f64, Cause cause, std::string evidence) const {
    if (f64 && !ask_.asked(*f64, {pair_})[0]) return {cause, false, evidence + ", but that build is wrong in float64"};
    if (size_.is_zero() || has_small_integers(pair_, lane_.scalar))
      return {cause, false, evidence + ", though only roots and quotients round here"};
    const Scales scales = scales_in_range(size_, lane_.scalar, kUsualFactors);
    for (const auto& [k, right] : ask_.tried(rounded, scales, 16)) {
      if (!right) return {cause, false, evidence + fmt::format(", but that build is wrong when scaled by 2^{}", k)};
    }
    if (subjects::selects_by_build(lane_)) return {cause, false, evidence + kSelects};
    if (cause == Cause::contraction && subjects::has_source_as_built(lane_) && subjects::fused_lines_of(lane_).empty())
      return {cause, false, evidence + ", but no fused product was found in its machine code"};
    if (by_values()) return {cause, false, evidence + ", but its verdict also changes with uninitialised variables"};
    return {cause, true, std::move(evidence)};
  }

  Ask<Real> asking() const {
    return [this](const std::vector<PairOf>& pairs) { return ask_.asked(lane_, pairs); };
  }

  const ScalarLimits& limits() const { return limits_of(lane_.scalar); }

  std::optional<DecidingNumber> number_that_decides() const {
    return deciding_number(
        lane_, [this](const DecideBlock& block) -> bool { return ask_.asked(block, {pair_})[0]; },
        [this](const DecideBlock& block) {
          if (!wrong_images_) wrong_images_ = wrong_images(pair_, asking());
          const std::vector<bool> right = ask_.asked(block, *wrong_images_, true);
          return !right.empty() && std::all_of(right.begin(), right.end(), std::identity());
        });
  }

  // Whether the lane is right at all scales above the turn, and wrong at all scales below it. Code that adds numbers
  // with different units, such as lengths and areas, becomes wrong again at other scales; code with a small epsilon
  // does not.
  bool turns_once(Turn turn) const {
    if (!turn.upwards()) return false;
    auto near = ask_.tried(lane_, common(strictly_, {turn.wrong - 12, turn.right + 12}), 26);
    const auto far = ask_.tried(lane_, strictly_, 32);
    near.insert(near.end(), far.begin(), far.end());
    return std::all_of(near.begin(), near.end(),
                       [&](const auto& one) { return one.second == (one.first >= turn.right); });
  }

  // Whether the lane is right, at the right scale of the turn, on a pair with another truth too. Code that gives one
  // answer for all large triangles is right there by luck.
  bool tells_apart(Turn turn) const {
    const Verdict other = truth_ == Verdict::intersects ? Verdict::disjoint : Verdict::intersects;
    const auto said = ask_.said(block_of(lane_), detail::pairs_of_other_truth(scaled(pair_, turn.right)));
    return std::find(said.begin(), said.end(), other) != said.end();
  }

  std::optional<Experiment> by_scale() {
    strictly_ = scales_in_range(size_, lane_.scalar, kMostFactors);
    if (!strictly_.empty()) {
      if (const auto turn = ask_.turn_within(strictly_, 16).turn) {
        turns_in_range_ = true;
        std::string text = fmt::format(
            "{}, and no product of up to {} coordinates leaves the exponents of {} at these "
            "scales",
            turn->text(), kMostFactors, limits().name);
        const bool once = turns_once(*turn), apart = once && tells_apart(*turn);
        if (!once) text += "; but its verdict changes at other scales too";
        if (once && !apart) text += "; but there it says the same of pairs with another truth";
        return Experiment{Cause::absolute_epsilon, apart, std::move(text)};
      }
    }
    const Scales in_range = scales_in_range(size_, lane_.scalar, kUsualFactors);
    if (in_range.empty()) return by_any_scale();
    const auto [turn, right, tried] = ask_.turn_within(in_range, 32);
    if (turn) {
      turns_in_range_ = true;
      if (!ask_.right_in_float64_at_every_scale()) return Experiment{Cause::absolute_epsilon, false, turn->text()};
      const Cause cause = by_exponents_at(*turn);
      return Experiment{
          cause, false,
          turn->text() + (cause == Cause::rounding ? "; in float64 it is right at all scales that were tried" : "")};
    }
    if (right) return outside(ask_.bisected(0, in_range.first > 0 ? in_range.first : in_range.last));
    wrong_at_ = tried;
    return beyond(in_range);
  }

  // Underflow or overflow, if some product of coordinates can underflow or overflow where the lane is wrong; otherwise
  // rounding.
  Cause by_exponents_at(Turn turn) const {
    const bool upwards = turn.upwards();
    const bool leaves = upwards ? kMostFactors * (size_.smallest_difference + turn.wrong) < limits().least
                                : kMostFactors * (size_.largest_difference + 1 + turn.wrong) >= limits().most;
    return !leaves ? Cause::rounding : upwards ? Cause::underflow : Cause::overflow;
  }

  // The lane is right at all scales in range, so the pair is out of range. The turn lies between the range and the
  // pair's own scale.
  Experiment outside(Turn turn) const {
    // Code that adds lengths and areas may be wrong here even without exponent limits. For doubles, no wider type can
    // rule out such code.
    constexpr bool kIsNarrow = sizeof(Real) == sizeof(float);
    const bool by_float64 = ask_.right_in_float64_at_every_scale();
    // If the code can run in doubles, but is wrong there too, a limit of its own may decide.
    const bool by_range = kIsNarrow && (!ask_.in_float64() || ask_.right_in_float64());
    const std::string text = turn.text(),
                      doubles = by_float64 ? ", and in float64 it is right at all scales that were tried" : "";
    if (turn.upwards()) {
      if (!by_float64 && kUsualFactors * (size_.smallest_difference + turn.wrong) >= limits().least)
        return {Cause::absolute_epsilon, false,
                text + fmt::format(", though products of its differences are not too small for {}", limits().name)};
      const bool lost = 3 * (size_.largest_difference + 1 + turn.wrong) <= limits().least;
      return {Cause::underflow, (by_range && lost) || (by_float64 && !strictly_.empty()),
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
    return {Cause::overflow, (by_range && lost) || (by_float64 && too_large(4)),
            lost ? text + fmt::format(", where products of three differences are too large for {}", limits().name)
                 : text + doubles};
  }

  // For pairs that have no scale at which every product stays in the exponent range.
  std::optional<Experiment> by_any_scale() const {
    const Scales all = exact_scales(size_);
    const auto up = ask_.tried(lane_, {1, all.last}, 24), down = ask_.tried(lane_, {all.first, -1}, 24);
    const auto is_right = [](const auto& one) { return one.second; };
    const auto above = std::find_if(up.begin(), up.end(), is_right);
    const auto below = std::find_if(down.rbegin(), down.rend(), is_right);
    if (above == up.end() && below == down.rend()) return std::nullopt;
    const bool upwards = below == down.rend() || (above != up.end() && above->first <= -below->first);
    const Turn turn = ask_.bisected(0, upwards ? above->first : below->first);
    const bool leaves = upwards ? kUsualFactors * (size_.smallest_difference + turn.wrong) < limits().least
                                : 4 * (size_.largest_difference + turn.wrong) >= limits().most;
    const Cause by_exponents = upwards ? Cause::underflow : Cause::overflow;
    return Experiment{leaves || ask_.right_in_float64_at_every_scale() ? by_exponents : Cause::absolute_epsilon, false,
                      turn.text()};
  }

  // The lane is wrong at all scales in range. It may be right at larger scales at which only longer products can
  // overflow.
  std::optional<Experiment> beyond(Scales in_range) const {
    const Scales more{in_range.last + 1, scales_in_range(size_, lane_.scalar, kUsualFactors / 2).last};
    const auto up = ask_.tried(lane_, more, 12);
    const auto right = std::find_if(up.begin(), up.end(), [](const auto& one) { return one.second; });
    if (right == up.end() || ask_.right_in_float64()) return std::nullopt;
    return Experiment{Cause::absolute_epsilon, false, ask_.bisected(in_range.last, right->first).text()};
  }

  std::optional<Experiment> by_precision() const {
    if (!ask_.right_in_float64()) return std::nullopt;
    // If sums and products are exact here, the code may be right by luck.
    const Lane* f64 = analysis::in_float64(lane_);
    const Lane* rounded = f64 ? counterpart(*f64, rounded_variant(f64->variant)) : nullptr;
    const bool as_written = !rounded || !backends::on_host(*rounded) || ask_.asked(*rounded, {pair_})[0];
    if (wrong_at_.empty() || !has_usual_exponents() || has_small_integers(pair_, lane_.scalar) || !as_written ||
        !ask_.right_in_float64_at_every_scale())
      return Experiment{Cause::rounding, false, ask_.in_float64_words() + "it is right"};
    if (!f64 && subjects::selects_by_build(lane_))
      return Experiment{Cause::rounding, false, ask_.in_float64_words() + "it is right" + kSelects};
    return Experiment{
        Cause::rounding, true,
        ask_.in_float64_words() + fmt::format("it is right, in float32 wrong at all scales that were tried, "
                                              "2^{} to 2^{}",
                                              wrong_at_.first, wrong_at_.last)};
  }

  const Lane& lane_;
  const PairOf& pair_;
  Verdict truth_;
  const Size size_;
  ImageVerdicts<Real> ask_;
  mutable std::optional<std::vector<PairOf>> wrong_images_;  // computed when first needed
  Scales strictly_{1, 0};          // scales at which even the longest products stay within the exponents
  bool turns_in_range_ = false;    // the verdict changes between two of these scales
  bool perhaps_vanishes_ = false;  // a small number decides, perhaps an absolute epsilon
  Scales wrong_at_{1, 0};          // tried scales at which usual products stay within the exponents; empty unless the
                                   // lane is wrong at all of these
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

Experiment known_experiment(const Lane& lane, Verdict verdict, const AnyPair& pair, Verdict truth) {
  using Key = std::tuple<std::string, Verdict, Verdict, std::string>;
  constexpr std::size_t kMostKnown = 20'000;  // about 20 MB
  static std::map<Key, Experiment> known;
  static std::mutex mutex;
  const auto made_on = [&](const auto& own) { return experiment(lane, verdict, own, truth); };
  if (find_lane(lane.id) != &lane) return visit(pair, made_on);
  const auto bytes = [](const auto& own) { return std::string(reinterpret_cast<const char*>(&own), sizeof own); };
  const Key key{lane.id, verdict, truth, visit(pair, bytes)};
  {
    const std::lock_guard lock(mutex);
    if (const auto found = known.find(key); found != known.end()) return found->second;
  }
  Experiment made = visit(pair, made_on);
  const std::lock_guard lock(mutex);
  if (known.size() >= kMostKnown) known.clear();
  return known.insert_or_assign(key, std::move(made)).first->second;
}

}  // namespace graze::analysis
