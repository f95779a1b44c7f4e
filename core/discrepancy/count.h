// SPDX-License-Identifier: Apache-2.0
// Compares the values that two lanes of one algorithm and scalar recorded for a pair, and counts the differences. The
// same code runs on host and device. Every count is an integer, so counts of parts add up to those of the whole.
#pragma once

#include <cstdint>

#include "core/algorithms/algorithms.h"
#include "core/discrepancy/led.h"
#include "core/exact/error_bound.h"
#include "core/exact/grid.h"
#include "core/margin/axis.h"
#include "core/margin/frame.h"

namespace graze {

// The counts of a value. A value is compared if both lanes recorded it and it has the same meaning in both. Distances
// and normals always have the same meaning; other values do if both lanes made the same choices.
namespace value_counts {
inline constexpr int kOctaves = 64, kErrors = 40;
enum : int {
  compared,
  equal,                           // the same bits, or both are NaN
  zero_sign,                       // zeros of different signs
  not_finite,                      // other differences; at least one value is not finite
  below,                           // kOctaves counts; in count k, the second lane's value is 2^k to 2^(k+1) ulps lower
  above = below + kOctaves,        // kOctaves counts: the same, but higher
  first_error = above + kOctaves,  // kErrors counts: the first lane's error, see error_bucket
  second_error = first_error + kErrors,
  nearer_first = second_error + kErrors,  // the values differ, and the first lane's is nearer to the exact value
  nearer_second,
  equally_near,
  nearer_unknown,  // the bounds do not decide, or one value is not finite
  kFields
};

// Buckets of a value's error, in ulps of the exact value (an ulp is at least the least subnormal number). 0: no error.
// 1: up to half an ulp. 2 + k: above 2^(k-1) and up to 2^k ulps; the last k has no limit. Two more buckets follow.
inline constexpr int kErrorNotFinite = kErrors - 2, kErrorUnknown = kErrors - 1;
}  // namespace value_counts

// The counts of a question. A question's sign is the sign of its value, or of the left value minus the right value.
namespace question_counts {
inline constexpr int kBands = 34, kLowestBand = -32;
enum : int {
  asked,    // asked by both lanes, and compared
  differs,  // some value's bits differ
  sign,     // the sign differs
  zero_on_one_side,
  outcome,  // the comparison's result differs; for a question about one value, the sign differs
  verdict,  // the verdicts differ, and this is the first question with a different outcome
  band,     // kBands counts; in count k, the sign differs, and the larger of both magnitudes is 2^(k + kLowestBand) to
            // twice that many error bounds; the first band has no lower limit. No magnitude exceeds two bounds, because
            // the values have different signs and each is within one bound of the exact value
  band_unknown = band + kBands,  // the error bound is infinite or NaN
  kFields
};
}  // namespace question_counts

// Counts of pairs by the site of a question. The last index is for comparisons without an epsilon.
namespace site_counts {
enum : int { asked, differs, sign, kFields };
}

namespace pair_counts {
enum : int {
  pairs,
  differs,  // some value differs
  sign,     // some sign or choice differs
  outcome,  // some outcome or choice differs
  choice,   // some choice differs
  verdict,  // the recorded verdicts differ
  kFields
};
}

// The layout of an algorithm's counts: pairs, pairs by site, pairs by place on the stratum's axis, and counts by
// question.
inline constexpr int kPlacesAt = pair_counts::kFields + (kSiteCount + 1) * site_counts::kFields;
inline constexpr int kValuesAt = kPlacesAt + kBucketCount * pair_counts::kFields;
GRAZE_HD constexpr int site_at(int site) { return pair_counts::kFields + site * site_counts::kFields; }
GRAZE_HD constexpr int place_at(int place) { return kPlacesAt + (place + kBucketMost) * pair_counts::kFields; }
GRAZE_HD constexpr int question_at(int question) {
  return kValuesAt + question * (2 * value_counts::kFields + question_counts::kFields);
}
GRAZE_HD constexpr int value_at(int question, int which) {
  return question_at(question) + question_counts::kFields + which * value_counts::kFields;
}
GRAZE_HD constexpr int counts_of(int questions) { return question_at(questions); }

// The largest magnitude at which a question's sign differs: in multiples of the error bound, and as a length in
// coordinate units. Each maximum is stored as the bits of a nonnegative double, which are ordered like integers.
namespace band_maxima {
enum : int { in_bounds, length, kFields };
}

inline namespace GRAZE_FP {

// Maps a number's bits to an integer, in the order of the values. Neighbours differ by 1, and both zeros give 0.
template <class Real>
GRAZE_HD std::int64_t ordered_bits(Real x) {
  constexpr auto kSign = exact::detail::Format<Real>::kSign;
  const auto bits = exact::detail::bits_of(x);
  const auto size = static_cast<std::int64_t>(bits & ~kSign);
  return (bits & kSign) != 0 ? -size : size;
}
template <class Real>
GRAZE_HD bool same_bits(Real x, Real y) {
  return (x != x && y != y) || exact::detail::bits_of(x) == exact::detail::bits_of(y);
}
template <class Real>
GRAZE_HD bool is_finite_value(Real x) {
  return x - x == 0;
}
template <class Real>
GRAZE_HD int sign_of_value(Real x) {
  return x != x ? 2 : (x > 0) - (x < 0);
}
template <class Real>
GRAZE_HD int order_of(Real x, Real y) {
  return x < y ? -1 : x > y ? 1 : x == y ? 0 : 2;
}

// Whether two results of order_of imply different answers to `left < right` (or to `left <= right`, if at_most).
GRAZE_HD inline bool answers_otherwise(int order, int other, bool at_most) {
  const bool yes = order == -1 || (at_most && order == 0), other_yes = other == -1 || (at_most && other == 0);
  return yes != other_yes;
}

// floor(log2(x)) of a positive number; for zero, a value less than all others.
GRAZE_HD inline int log2_of(const DoubleDouble& x) {
  const bool is_subnormal = x.hi < 0x1p-1022;  // floor_log2 requires a normal number
  const double scale = is_subnormal ? 0x1p+54 : 1, hi = x.hi * scale, lo = x.lo * scale;
  const int k = floor_log2(hi);
  return (lo < 0 && hi == scalbn(1.0, k) ? k - 1 : k) - (is_subnormal ? 54 : 0);
}

// log2 of the ulp at this size.
template <class Real>
GRAZE_HD int log2_ulp_of(const DoubleDouble& size) {
  constexpr int kDigits = sizeof(Real) == sizeof(float) ? 24 : 53,
                kLeast = sizeof(Real) == sizeof(float) ? -149 : -1074;
  const int k = size.hi > 0 ? log2_of(size) - (kDigits - 1) : kLeast;
  return k < kLeast ? kLeast : k;
}

// Bounds on a magnitude.
struct SizeRange {
  DoubleDouble least, most;
};

// The bounds on |x|, rounded outward unless x is exact.
GRAZE_HD inline SizeRange size_range(const Certified& x) {
  const double sign = x.hi < 0 ? -1 : 1;
  const DoubleDouble size(sign * x.hi, sign * x.lo);
  if (x.bound == 0) return {size, size};
  const double slack = x.bound + size.hi * 0x1p-100;
  const DoubleDouble least = size - DoubleDouble(slack);
  return {least.hi > 0 ? least : DoubleDouble(0), size + DoubleDouble(slack)};
}

template <class Real>
GRAZE_HD SizeRange error_range(Real value, const Certified& exact) {
  return size_range(Certified(static_cast<double>(value)) - exact);
}

// The bucket of an error of this size. One ulp is 2^ulp.
GRAZE_HD inline int error_bucket(const DoubleDouble& size, int ulp) {
  if (!(size.hi > 0)) return 0;
  const int k = log2_of(size), up = k - ulp + (size.hi != scalbn(1.0, k) || size.lo != 0);  // ceil(log2)
  const int bucket = up <= -1 ? 1 : 2 + up;
  return bucket < value_counts::kErrorNotFinite ? bucket : value_counts::kErrorNotFinite - 1;
}

// The bucket of the error, if its whole range is in one bucket for every ulp that the exact value may have.
template <class Real>
GRAZE_HD int error_bucket(Real value, const Certified& exact) {
  using namespace value_counts;
  if (!is_finite_value(value)) return kErrorNotFinite;
  if (!exact.settled()) return kErrorUnknown;
  const SizeRange error = error_range(value, exact), size = size_range(exact);
  if (!(error.most.hi < HUGE_VAL)) return kErrorUnknown;
  const int bucket = error_bucket(error.least, log2_ulp_of<Real>(size.most));
  return bucket == error_bucket(error.most, log2_ulp_of<Real>(size.least)) ? bucket : kErrorUnknown;
}

// The distance between two finite numbers, in ulps.
template <class Real>
GRAZE_HD std::uint64_t apart(Real x, Real y) {
  const std::int64_t first = ordered_bits(x), second = ordered_bits(y);
  return second < first ? static_cast<std::uint64_t>(first) - static_cast<std::uint64_t>(second)
                        : static_cast<std::uint64_t>(second) - static_cast<std::uint64_t>(first);
}

// Whether the runs made different choices. A run that ended earlier made fewer choices.
GRAZE_HD inline bool chose_otherwise(std::uint64_t first, std::uint64_t second) {
  for (int c = 0; c < kMostChoices; ++c) {
    const std::uint64_t x = first >> 4 * c & 15, y = second >> 4 * c & 15;
    if (x != 0 && y != 0 && x != y) return true;
  }
  return false;
}

// Whether both runs asked this question about the same quantities. Distances and normals do not depend on choices.
GRAZE_HD inline bool have_both(const RecordedPath& first, const RecordedPath& second, int question, int site) {
  if (((first.asked & second.asked) >> question & 1) == 0) return false;
  return site == static_cast<int>(Site::plane_distance) || site == static_cast<int>(Site::parallel) ||
         !chose_otherwise(first.path, second.path);
}

// The parts of a lane's run that the counts of one pair need.
template <class Real>
struct Run {
  Recorded<const Real> values;
  RecordedPath path;

  GRAZE_HD Real value(int question, int which) const {
    return values.values[(2 * static_cast<unsigned>(question) + static_cast<unsigned>(which)) * values.stride];
  }
};

// Sink: add(index) adds 1 to a count, and most(question, which, size) keeps the largest size. degrees: the values of
// question q have the unit length^degrees[q].
template <class Real, class Sink>
class PairComparison {
 public:
  GRAZE_HD PairComparison(const Run<Real>& first, const Run<Real>& second, const std::uint8_t* degrees, double extent,
                          Sink& sink)
      : lane_{first, second}, degrees_(degrees), extent_(extent), sink_(sink) {
    choice_differs_ = chose_otherwise(first.path.path, second.path.path);
    verdict_differs_ = (first.path.path ^ second.path.path) >> 60 != 0;
  }

  // LedPolicy calls these functions for each question.
  GRAZE_HD GRAZE_CALLED void one(int question, int site, const Unrounded& value) {
    if (!compared(question, site)) return;
    const Real x = lane_[0].value(question, 0), y = lane_[1].value(question, 0);
    const bool differs = compare(question, 0, value.exact);
    const int sign = sign_of_value(x), other = sign_of_value(y);
    conclude(question, site, differs, sign, other, sign != other, larger(fabs(x), fabs(y)), value.rounding);
  }
  GRAZE_HD GRAZE_CALLED void two(int question, int site, const Unrounded& left, const Unrounded& right, bool at_most) {
    if (!compared(question, site)) return;
    const bool left_differs = compare(question, 0, left.exact), right_differs = compare(question, 1, right.exact);
    const Real x[2] = {lane_[0].value(question, 0), lane_[0].value(question, 1)};
    const Real y[2] = {lane_[1].value(question, 0), lane_[1].value(question, 1)};
    const int order = order_of(x[0], x[1]), other = order_of(y[0], y[1]);
    const double size = larger(fabs(static_cast<double>(x[0]) - static_cast<double>(x[1])),
                               fabs(static_cast<double>(y[0]) - static_cast<double>(y[1])));
    conclude(question, site, left_differs || right_differs, order, other, answers_otherwise(order, other, at_most),
             size, left.rounding + right.rounding);
  }

  // Counts the pair among all pairs if `at` is 0, otherwise among the pairs at place `at`. Call this after all
  // questions.
  GRAZE_HD void count_pair(int at) {
    using namespace pair_counts;
    sink_.add(at + pairs);
    if (some_differs_) sink_.add(at + pair_counts::differs);
    if (some_sign_ || choice_differs_) sink_.add(at + pair_counts::sign);
    if (some_outcome_ || choice_differs_) sink_.add(at + pair_counts::outcome);
    if (choice_differs_) sink_.add(at + pair_counts::choice);
    if (verdict_differs_) sink_.add(at + pair_counts::verdict);
  }
  GRAZE_HD void count_sites() {
    for (int s = 0; s <= kSiteCount; ++s) {
      for (int f = 0; f < site_counts::kFields; ++f) {
        if (sites_ >> (s * site_counts::kFields + f) & 1) sink_.add(site_at(s) + f);
      }
    }
  }

 private:
  GRAZE_HD static double larger(double x, double y) { return x < y ? y : x; }

  GRAZE_HD bool compared(int question, int site) const {
    if (!choice_differs_) return ((lane_[0].path.asked & lane_[1].path.asked) >> question & 1) != 0;
    return have_both(lane_[0].path, lane_[1].path, question, site);
  }

  // Counts one value of both lanes. Returns: whether its bits differ.
  GRAZE_HD GRAZE_CALLED bool compare(int question, int which, const Certified& exact) {
    using namespace value_counts;
    const int at = value_at(question, which);
    const Real x = lane_[0].value(question, which), y = lane_[1].value(question, which);
    const auto count = [&](int field) { sink_.add(at + field); };
    count(value_counts::compared);
    count(first_error + error_bucket(x, exact));
    count(second_error + error_bucket(y, exact));
    if (same_bits(x, y)) return count(equal), false;
    if (x == y) {
      count(zero_sign);
      count(equally_near);
      return true;
    }
    if (!is_finite_value(x) || !is_finite_value(y)) {
      count(not_finite);
      count(nearer_unknown);
      return true;
    }
    count((y < x ? below : above) + highest_bit(apart(x, y)));
    count(nearer(x, y, exact));
    return true;
  }

  GRAZE_HD static int highest_bit(std::uint64_t x) {
    int k = 0;
    for (int step = 32; step > 0; step /= 2) {
      if (x >> step) {
        x >>= step;
        k += step;
      }
    }
    return k;
  }

  GRAZE_HD static int nearer(Real x, Real y, const Certified& exact) {
    using namespace value_counts;
    if (!exact.settled()) return nearer_unknown;
    const SizeRange first = error_range(x, exact), second = error_range(y, exact);
    if (first.most < second.least) return nearer_first;
    if (second.most < first.least) return nearer_second;
    return first.most == second.least && second.most == first.least ? equally_near : nearer_unknown;
  }

  GRAZE_HD void conclude(int question, int site, bool differs, int sign, int other, bool outcome, double size,
                         double rounding) {
    using namespace question_counts;
    const int at = question_at(question);
    sink_.add(at + asked);
    mark(site, site_counts::asked);
    if (differs) {
      sink_.add(at + question_counts::differs);
      mark(site, site_counts::differs);
      some_differs_ = true;
    }
    if (sign == other) return;
    sink_.add(at + question_counts::sign);
    mark(site, site_counts::sign);
    some_sign_ = true;
    if (sign == 0 || other == 0) sink_.add(at + zero_on_one_side);
    count_band(question, size, rounding);
    if (!outcome) return;
    sink_.add(at + question_counts::outcome);
    if (verdict_differs_ && !some_outcome_) sink_.add(at + question_counts::verdict);
    some_outcome_ = true;
  }

  GRAZE_HD void count_band(int question, double size, double rounding) {
    using namespace question_counts;
    const int at = question_at(question);
    const double in_bounds = size / rounding;
    if (!(rounding < HUGE_VAL) || !(in_bounds < HUGE_VAL)) return sink_.add(at + band_unknown);
    int k = in_bounds > 0 ? floor_log2(in_bounds) - kLowestBand : 0;
    k = k < 0 ? 0 : k >= kBands ? kBands - 1 : k;
    sink_.add(at + band + k);
    double length = size;
    for (int d = 1; d < degrees_[question]; ++d) length /= extent_;
    sink_.most(question, band_maxima::in_bounds, in_bounds);
    if (length < HUGE_VAL) sink_.most(question, band_maxima::length, length);
  }

  GRAZE_HD void mark(int site, int field) { sites_ |= 1u << (site * site_counts::kFields + field); }

  Run<Real> lane_[2];
  const std::uint8_t* degrees_;
  double extent_;
  Sink& sink_;
  bool choice_differs_ = false, verdict_differs_;
  bool some_differs_ = false, some_sign_ = false, some_outcome_ = false;
  std::uint32_t sites_ = 0;  // bit site * kFields + field
};

// A hash of everything that a run recorded. All NaNs count as one value, because their payloads differ by processor.
template <class Real>
GRAZE_HD std::uint64_t run_hash(const Real* values, std::uint64_t stride, const RecordedPath& path,
                                std::uint64_t two_values) {
  std::uint64_t hash = path.asked ^ path.path * 0x9e3779b97f4a7c15u;  // as in Knuth's multiplicative hash
  for (int question = 0; question < kMostQuestions; ++question) {
    if ((path.asked >> question & 1) == 0) continue;
    for (unsigned which = 0; which <= (two_values >> question & 1); ++which) {
      const Real x = values[(2 * static_cast<unsigned>(question) + which) * stride];
      const std::uint64_t bits = x != x ? 0x7fffffffu : exact::detail::bits_of(x);
      const std::uint64_t mixed = (hash ^ bits) * 0x9e3779b97f4a7c15u;
      hash = mixed ^ mixed >> 32;
    }
  }
  return hash;
}

// Compares the runs of two lanes on one pair. axis: the axis of the pair's stratum.
template <class Algorithm, class Real, class Sink>
GRAZE_HD void compare_runs(const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3], const Run<Real>& first,
                           const Run<Real>& second, const std::uint8_t* degrees, Axis axis, Sink& sink) {
  const exact::detail::Vec<double> extents = exact::detail::extent_of(&a[0].x, &b[0].x);
  const double extent = greater(extents.x, greater(extents.y, extents.z));
  PairComparison<Real, Sink> comparison(first, second, degrees, extent, sink);
  run_led<Algorithm>(a, b, first.values, first.path, comparison);
  comparison.count_pair(0);
  comparison.count_sites();
  if (axis == Axis::none) return;
  BasicPair<Real> pair;
  for (int v = 0; v < 3; ++v) {
    pair.a[v] = a[v];
    pair.b[v] = b[v];
  }
  comparison.count_pair(place_at(place_on_axis(pair, axis)));
}

}  // namespace GRAZE_FP
}  // namespace graze
