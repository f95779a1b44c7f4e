// SPDX-License-Identifier: Apache-2.0
#include "analysis/experiments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "analysis/scales.h"
#include "backends/backends.h"
#include "core/lanes/verdicts.h"
#include "core/relation_of.h"

namespace graze::analysis {
namespace {

// No more verdicts are requested after this many time-outs.
constexpr int kMostLate = 3;

// For each pair, whether the lane is right. `late` counts the time-outs so far; pairs that were not tried are false.
std::vector<bool> right_on(const Lane& lane, const std::vector<Pair>& pairs, Verdict truth, int& late) {
  constexpr std::size_t kAtOnce = 8;
  std::vector<bool> right(pairs.size());
  const DecideBlock block = block_of(lane);
  for (std::size_t begin = 0; begin < pairs.size() && late < kMostLate; begin += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, pairs.size() - begin);
    const std::vector<Verdict> said = verdicts_of(block, std::span(pairs).subspan(begin, count));
    for (std::size_t i = 0; i < count; ++i) {
      right[begin + i] = said[i] == truth;
      late += said[i] == Verdict::timed_out;
    }
  }
  return right;
}

int count_of(const std::vector<bool>& right) { return static_cast<int>(std::count(right.begin(), right.end(), true)); }

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

class Trial {
 public:
  Trial(const Lane& lane, const Pair& pair, Verdict truth) : lane_(lane), pair_(pair), truth_(truth), size_(pair) {}

  Experiment run() {
    Experiment found = cause();
    if (late_ < kMostLate) return found;
    found.settled = false;
    found.slow = true;
    found.evidence += "; on other pairs it gave no answer in time, so not all experiments were made";
    return found;
  }

 private:
  Experiment cause() {
    if (const Lane* rounded = counterpart(lane_, rounded_variant(lane_.variant));
        rounded && rounded != &lane_ && backends::on_host(*rounded) && asked(*rounded, {pair_})[0]) {
      if (info_of(lane_.variant).arithmetic == Arithmetic::fast)
        return by_build(*rounded, Cause::fast_math, "built so that every operation rounds as written it is right");
      return by_build(*rounded, Cause::contraction, "built without contraction it is right");
    }
    if (size_.high > -1000) {
      if (auto found = by_scale()) return *found;
    }
    if (auto found = by_precision()) return *found;
    return has_few_bits() && scale_is_no_matter_ ? without_rounding() : by_images();
  }

  // Whether no sum and no product of up to kUsualFactors differences rounds.
  bool has_few_bits() const { return kUsualFactors * (size_.high - size_.low + 1) + 5 <= limits().digits; }

  // Whether products of differences stay within the exponents, as far as that can be known. Overflow is checked for the
  // longest products; underflow only for the usual ones, whose factors may all be small.
  bool has_usual_exponents() const {
    return kUsualFactors * size_.smallest_difference >= limits().least &&
           kMostFactors * (size_.largest_difference + 1) < limits().most;
  }

  // Code that is wrong in exact arithmetic may be right on this pair by luck. Float64 or another scale reveals that.
  Experiment by_build(const Lane& rounded, Cause cause, std::string evidence) const {
    const Lane* f64 = in_float64(rounded);
    if (f64 && !asked(*f64, {pair_})[0]) return {cause, false, evidence + ", but that build is wrong in float64"};
    if (size_.high == -1000 || has_few_bits())
      return {cause, false, evidence + ", though only roots and quotients round here"};
    const Scales scales = scales_in_range(size_, lane_.scalar, kUsualFactors);
    for (const auto& [k, right] : tried(rounded, scales, 16)) {
      if (!right) return {cause, false, evidence + fmt::format(", but that build is wrong when scaled by 2^{}", k)};
    }
    return {cause, true, std::move(evidence)};
  }

  std::vector<bool> asked(const Lane& lane, const std::vector<Pair>& pairs) const {
    return right_on(lane, pairs, truth_, late_);
  }

  const ScalarLimits& limits() const { return limits_of(lane_.scalar); }

  // Tries at most `most` evenly spaced scales. Returns each scale and whether the lane is right there.
  std::vector<std::pair<int, bool>> tried(const Lane& lane, Scales scales, int most) const {
    std::vector<std::pair<int, bool>> result;
    if (scales.empty()) return result;
    const int step = std::max(1, (scales.last - scales.first) / most + 1);
    std::vector<Pair> pairs;
    for (int k = scales.first; k <= scales.last; k += step) {
      result.emplace_back(k, false);
      pairs.push_back(scaled(pair_, k));
    }
    const std::vector<bool> right = asked(lane, pairs);
    for (std::size_t i = 0; i < right.size(); ++i) result[i].second = right[i];
    return result;
  }

  // Finds a turn between these two scales.   Requires: the lane is wrong at the first and right at the second.
  Turn bisected(int wrong, int right) const {
    while (std::abs(right - wrong) > 1) {
      const int middle = wrong + (right - wrong) / 2;
      (asked(lane_, {scaled(pair_, middle)})[0] ? right : wrong) = middle;
    }
    return {wrong, right};
  }

  // Whether the same code in float64 is right wherever no product leaves its exponents.
  bool right_in_float64_at_every_scale() const {
    const Lane* f64 = in_float64(lane_);
    if (!f64) return false;
    const Scales scales = scales_in_range(size_, Scalar::f64, kMostFactors);
    const auto all = tried(*f64, scales, 24);
    return scales.has(0) && std::all_of(all.begin(), all.end(), [](const auto& one) { return one.second; });
  }

  // Finds two neighbouring scales in range such that the lane is right at one of them only. Prefers a turn at which the
  // larger scale is right. Sets `all` to whether the lane is right at every scale tried.
  std::optional<Turn> turn_within(Scales in_range, int most, bool& all) const {
    auto inside = tried(lane_, in_range, most);
    const std::pair own{0, false};
    if (in_range.has(0)) inside.insert(std::lower_bound(inside.begin(), inside.end(), own), own);
    all = inside[0].second;
    for (const bool upwards : {true, false}) {
      for (std::size_t i = inside.size() - 1; i > 0; --i) {
        const auto [k, right] = inside[i];
        if (right != upwards || inside[i - 1].second == upwards) continue;
        return upwards ? bisected(inside[i - 1].first, k) : bisected(k, inside[i - 1].first);
      }
    }
    return std::nullopt;
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
    bool right = false;
    strictly_ = scales_in_range(size_, lane_.scalar, kMostFactors);
    if (!strictly_.empty()) {
      if (const auto turn = turn_within(strictly_, 16, right)) {
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
    if (const auto turn = turn_within(in_range, 32, right)) {
      if (!right_in_float64_at_every_scale()) return Experiment{Cause::absolute_epsilon, false, turn->text()};
      return Experiment{turn->right > turn->wrong ? Cause::underflow : Cause::overflow, false, turn->text()};
    }
    if (right) return outside(bisected(0, in_range.first > 0 ? in_range.first : in_range.last));
    scale_is_no_matter_ = true;
    return beyond(in_range);
  }

  // The lane is right at all scales in range, so the pair is out of range. The lane turns wrong between the range and
  // the pair.
  Experiment outside(Turn turn) const {
    const bool by_float64 = right_in_float64_at_every_scale();
    const std::string text = turn.text(), doubles = by_float64 ? ", and in float64 it is right at every scale" : "";
    if (turn.right > turn.wrong) {
      if (!by_float64 && kUsualFactors * (size_.smallest_difference + turn.wrong) >= limits().least)
        return {Cause::absolute_epsilon, false,
                text + fmt::format(", though products of its differences are not too small for {}", limits().name)};
      const bool lost = 3 * (size_.largest_difference + 1 + turn.wrong) <= limits().least;
      return {Cause::underflow, lost || (by_float64 && !strictly_.empty()),
              lost ? text + fmt::format(", where every product of three differences is too small for {}", limits().name)
                   : text + doubles};
    }
    const auto too_large = [&](int factors) {
      return factors * (size_.largest_difference + turn.wrong) >= limits().most;
    };
    const bool lost = too_large(3);
    return {Cause::overflow, lost || (by_float64 && too_large(4)),
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
    const bool small = kUsualFactors * (size_.smallest_difference + turn.wrong) < limits().least;
    return Experiment{!upwards                                     ? Cause::overflow
                      : small || right_in_float64_at_every_scale() ? Cause::underflow
                                                                   : Cause::absolute_epsilon,
                      false, turn.text()};
  }

  // The lane is wrong at all scales in range. It may turn right some way above, where only longer products can
  // overflow.
  std::optional<Experiment> beyond(Scales in_range) const {
    const Scales more{in_range.last + 1, scales_in_range(size_, lane_.scalar, kUsualFactors / 2).last};
    const auto up = tried(lane_, more, 12);
    const auto right = std::find_if(up.begin(), up.end(), [](const auto& one) { return one.second; });
    const Lane* f64 = in_float64(lane_);
    if (right == up.end() || (f64 && asked(*f64, {pair_})[0])) return std::nullopt;
    return Experiment{Cause::absolute_epsilon, false, bisected(in_range.last, right->first).text()};
  }

  std::optional<Experiment> by_precision() const {
    const Lane* f64 = in_float64(lane_);
    if (!f64 || !asked(*f64, {pair_})[0]) return std::nullopt;
    // If sums and products are exact here, it may be right by luck.
    const Lane* rounded = counterpart(*f64, rounded_variant(f64->variant));
    const bool as_written = !rounded || !backends::on_host(*rounded) || asked(*rounded, {pair_})[0];
    if (!scale_is_no_matter_ || !has_usual_exponents() || has_few_bits() || !as_written ||
        !right_in_float64_at_every_scale())
      return Experiment{Cause::rounding, false, "in float64 it is right"};
    return Experiment{Cause::rounding, true, "in float64 it is right, in float32 wrong at every scale"};
  }

  bool is_degenerate() const {
    const Hulls hulls = relation_of(pair_).hulls;
    return hulls.dimension_a < 2 || hulls.dimension_b < 2;
  }

  // The cause if sums and products do not round.
  Experiment without_rounding() const {
    const std::string exactly =
        fmt::format("no sum and no product of up to {} differences rounds in {} here", kUsualFactors, limits().name);
    const std::vector<Pair> other_orders = orders(pair_), mirror_images = mirrored(pair_);
    const int in_orders = count_of(asked(lane_, other_orders));
    const int in_mirrors = count_of(asked(lane_, mirror_images));
    // Multiples other than powers of two change how roots and quotients round.
    std::vector<Pair> multiples;
    for (const float factor : {3.0f, 5.0f, 7.0f, 11.0f, 13.0f}) {
      Pair& multiple = multiples.emplace_back(pair_);
      for (int i = 0; i < kCoordinates; ++i) coordinates(multiple)[i] *= factor;  // few bits: exact, but for overflow
    }
    const bool in_multiples = count_of(asked(lane_, multiples)) > 0;
    std::string where = ", and it is wrong in all orders, mirror images and scales";
    if (in_multiples) where = ", but scaled by other numbers than powers of two it is right";
    if (in_orders + in_mirrors > 0)
      where = fmt::format(", but in {} of {} orders and {} of {} mirror images it is right", in_orders,
                          other_orders.size(), in_mirrors, mirror_images.size());
    const Cause cause = is_degenerate() ? Cause::degenerate_input
                        : in_orders > 0 ? Cause::order_dependent
                                        : Cause::logic;
    return {cause, in_orders + in_mirrors == 0 && !in_multiples, exactly + where};
  }

  // Translates each vertex to the origin, if that is exact.
  std::vector<Pair> translated() const {
    std::vector<Pair> result;
    if (size_.high - size_.low + 1 > 53) return result;  // differences are exact in doubles only up to this size
    for (const Vec3<float>* vertex = pair_.a; vertex != pair_.a + 6; ++vertex) {
      Pair moved;
      bool exact = true;
      for (int i = 0; i < kCoordinates; ++i) {
        const double difference = double{coordinates(pair_)[i]} - (&vertex->x)[i % 3];
        coordinates(moved)[i] = static_cast<float>(difference);
        exact = exact && coordinates(moved)[i] == difference;
      }
      if (exact) result.push_back(moved);
    }
    return result;
  }

  // Rounds the pair to fewer bits, if that keeps its truth and shape.
  std::vector<Pair> snapped() const {
    std::vector<Pair> result;
    const Relation own = relation_of(pair_);
    for (const int bits : {1, 2, 3, 4, 6, 8, 10, 12, 16, 20}) {
      if (bits >= size_.high - size_.low) break;
      Pair rounded = pair_;
      const int unit = size_.high - bits;
      for (int i = 0; i < kCoordinates; ++i)
        coordinates(rounded)[i] = std::ldexp(std::nearbyint(std::ldexp(coordinates(pair_)[i], -unit)), unit);
      if (!is_finite(rounded)) continue;
      const Relation now = relation_of(rounded);
      if (now.contact == own.contact && now.hulls == own.hulls) result.push_back(rounded);
    }
    return result;
  }

  Experiment by_images() const {
    struct Images {
      std::string_view what;
      std::vector<Pair> pairs;
    };
    const Images kinds[] = {{"orders", orders(pair_)},
                            {"mirror images", mirrored(pair_)},
                            {"exact translations to a vertex", translated()},
                            {"roundings to fewer bits with the same truth", snapped()}};
    std::string right, wrong;
    int right_in[std::size(kinds)];
    for (std::size_t i = 0; i < std::size(kinds); ++i) {
      right_in[i] = count_of(asked(lane_, kinds[i].pairs));
      if (kinds[i].pairs.empty()) continue;
      std::string& list = right_in[i] > 0 ? right : wrong;
      list += fmt::format("{}{} of {} {}", list.empty() ? "" : ", ", right_in[i], kinds[i].pairs.size(), kinds[i].what);
    }
    if (right.empty()) return {is_degenerate() ? Cause::degenerate_input : Cause::logic, false, "right in " + wrong};
    const bool orders_alone = right_in[0] > 0 && right_in[1] + right_in[2] + right_in[3] == 0;
    const bool tried_others = kinds[3].pairs.size() > 1;
    return {orders_alone && tried_others ? Cause::order_dependent : Cause::rounding, false,
            "right in " + right + (wrong.empty() ? "" : ", and in " + wrong)};
  }

  const Lane& lane_;
  const Pair& pair_;
  Verdict truth_;
  Size size_;
  mutable int late_ = 0;
  Scales strictly_{1, 0};            // scales at which even the longest products stay within the exponents
  bool scale_is_no_matter_ = false;  // wrong at all scales at which the usual products stay within the exponents
};

}  // namespace

Experiment experiment(const Lane& lane, Verdict verdict, const Pair& pair, Verdict truth) {
  switch (verdict) {
    case Verdict::crashed:
      return {Cause::crash, true, "its process ended"};
    case Verdict::timed_out:
      return {Cause::no_answer, true, "it exceeded its time limit"};
    case Verdict::unstable:
      return {Cause::unstable, true, "it gives another answer when it is asked about the same pair again"};
    default:
      return Trial(lane, pair, truth).run();
  }
}

}  // namespace graze::analysis
