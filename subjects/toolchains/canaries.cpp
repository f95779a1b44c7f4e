// SPDX-License-Identifier: Apache-2.0
#include "subjects/toolchains/canaries.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <type_traits>

namespace graze::subjects {
namespace {

constexpr std::uint64_t kQuotients = 16384, kRoots = 4096;  // as in canaries.c

// The bits of a result. kNan stands for every NaN, because a NaN's sign and payload depend on the processor.
using Expected = std::optional<std::uint64_t>;
constexpr Expected kNan = std::nullopt;

// Results of a canary that are not rounded as written.
struct Other {
  Rounding rounding;
  std::string words;
  std::vector<Expected> results;
  bool partly = false;  // whether some results may be rounded as written
};

struct Canary {
  std::string name, code;
  Rounding least;  // the strictest rounding that permits `others`
  std::vector<Expected> as_written;
  std::vector<Other> others = {};
  bool across = false;  // whether `least` must be permitted across statements
};

template <class Real>
using BitsOf = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;

// The canaries for one type. All numbers here are exact: each is a sum of a few powers of two. u is half an ulp of 1.
// h is the same as in canaries.c: 4 h^2 is at most u / 4, and half an ulp below 1 is u / 2. So (1 + h)(1 - h) and
// (1 + 2h)(1 - 2h) round to 1.
template <class Real>
std::vector<Canary> canaries() {
  using enum Rounding;
  constexpr int digits = std::numeric_limits<Real>::digits;
  const auto bits = [](Real x) { return Expected(std::bit_cast<BitsOf<Real>>(x)); };
  const auto all = [&](std::initializer_list<Real> values) {
    std::vector<Expected> result;
    for (const Real x : values) result.push_back(std::isnan(x) ? kNan : bits(x));
    return result;
  };
  const Real u = std::ldexp(Real{1}, -digits), h = std::ldexp(Real{1}, -(digits + 1) / 2 - 2), hh = h * h;
  const Real infinity = std::numeric_limits<Real>::infinity(), nan = std::numeric_limits<Real>::quiet_NaN();
  const Real least = std::numeric_limits<Real>::min(),
             most = std::ldexp(Real{1}, std::numeric_limits<Real>::max_exponent - 1);
  const Real denormal = std::numeric_limits<Real>::denorm_min();
  const Real large = std::ldexp(Real{1}, digits == 24 ? 100 : 1000);
  // In the canary `fma`, the product a*b is low + u, which lies halfway between low and low + 2u. The last digit of low
  // is 0.
  const Real low = 1 + std::ldexp(Real{1}, -(digits / 2)) + std::ldexp(Real{1}, -(digits - digits / 2));
  // The exact product a*b is 1 - hh, so a*b - 1 is -hh unless the product is rounded.
  const std::vector<Other> not_rounded = {{contracted, "fused", all({-hh})}};
  // A sequential sum loses the 15 terms between 2^100 and -2^100, and is 47. Sums in parts keep some of these.
  std::vector<Other> regrouped;
  for (int kept = 48; kept <= 62; ++kept) regrouped.push_back({fast, "regrouped", all({static_cast<Real>(kept)})});
  regrouped.push_back({fast, "regrouped", all({0})});
  return {
      {"expression", "a*b + c", contracted, all({0}), not_rounded},
      // Here a*b = 1 - hh and c*d = 1 - 4hh.
      {"difference",
       "a*b - c*d",
       contracted,
       all({0}),
       {{contracted, "left fused", all({-hh})},
        {contracted, "right fused", all({4 * hh})},
        {excess, "excess digits", all({3 * hh})}}},
      // The dot product's first two terms are the products of `difference`; in the second result, its last two are.
      {"dot",
       "dot product of 3",
       contracted,
       all({0, 0}),
       {{contracted, "1st, 3rd fused", all({-hh, 4 * hh})},
        {contracted, "2nd, 3rd fused", all({4 * hh, 4 * hh})},
        {contracted, "1st fused", all({-hh, 0})},
        {contracted, "2nd fused", all({4 * hh, 0})},
        {contracted, "3rd fused", all({0, 4 * hh})},
        {excess, "excess digits", all({3 * hh, 3 * hh})}}},
      {"loop",
       "sum += a[i]*b[i]",
       contracted,
       all({0}),
       {{contracted, "fused", all({4 * hh})}, {excess, "excess digits", all({3 * hh})}}},
      {"statements", "t = a*b; t + c", contracted, all({0}), not_rounded, true},
      {"inlined", "times(a, b) + c", contracted, all({0}), not_rounded, true},
      {"called", "(*times)(a, b) + c", contracted, all({0}), not_rounded, true},
      // Each lost term is u / 64.
      {"sum",
       "a + b + c",
       excess,
       all({0}),
       {{excess, "excess digits", all({u / 64})}, {fast, "regrouped", all({u / 64})}}},
      {"sum_in_loop",
       "sum += a[i]",
       excess,
       all({0}),
       {{excess, "excess digits", all({u / 32})},
        {fast, "regrouped", all({u / 64})},
        {fast, "regrouped", all({u / 32})}},
       true},
      {"order",
       "order of a + b + c",
       fast,
       all({1, 0, 0}),
       {{fast, "regrouped", all({0, 1, 0})}, {fast, "regrouped", all({0, 0, 1})}}},
      {"order_in_loop", "order of sum += a[i]", fast, all({47}), regrouped},
      // The sums 1 + u and 1 + 3u lie halfway between neighbouring numbers. 1 + u (1 + 2u) lies just above halfway.
      {"nearest",
       "a + b",
       excess,
       all({1, 1 + 4 * u, 1 + 2 * u}),
       {{excess, "rounded twice", all({1, 1 + 4 * u, 1})}, {excess, "too few digits", all({1, 1, 1})}}},
      {"range", "a*b / c", excess, all({infinity}), {{excess, "excess range", all({large})}}},
      {"range_assigned", "t = a*b; t / c", excess, all({infinity}), {{excess, "excess range", all({large})}}, true},
      {"range_called", "(*times)(a, b) / c", excess, all({infinity}), {{excess, "excess range", all({large})}}, true},
      {"range_stored", "a*b stored; a*b / c", fast, all({infinity}), {{excess, "excess range", all({large})}}},
      // The divisor d is 41 for float and 49 for double. The product of d and its rounded reciprocal rounds to 1 - u.
      {"reciprocal",
       "a/d, b/d, c/d",
       fast,
       all({1, 1, 1, 1}),
       {{fast, "times 1/d", all({1 - u, 1 - u, 1 - u, 1 - u}), true}}},
      {"division", "a / b, hard cases", excess, {0, kQuotients}},
      {"root", "sqrt(a), hard cases", excess, {0, kRoots}},
      // The results in order: (1 - hh) - 1; low + u rounded to even, up, and down; low + 3u rounded to even; u (1 -
      // 4uu) added to 1 + 2u; a product beyond the range; a little more than half of the least subnormal number, added
      // to twice that number; zeros.
      {"fma", "fma(a, b, c)", fast,
       all({-hh, low, low + 2 * u, low, low + 4 * u, 1 + 2 * u, most, 3 * denormal, 0, -Real{0}})},
      {"identities",
       "a/a, a - a, 0*a",
       fast,
       all({nan, nan, nan, nan}),
       {{fast, "simplified", all({1, 1, 0, 0}), true}}},
      {"subnormal_result",
       "subnormal result",
       fast,
       all({least / 2, least / 2}),
       {{fast, "flushed to 0", all({0, 0}), true}}},
      {"subnormal_nearest",
       "a*b, subnormal",
       excess,
       all({denormal}),
       {{excess, "rounded twice", all({2 * denormal})}, {fast, "flushed to 0", all({0})}}},
      // The input is three times the smallest positive subnormal number.
      {"subnormal_input", "subnormal input", fast, all({3 * denormal * (most / 2)}), {{fast, "read as 0", all({0})}}},
      {"zeros",
       "signs of zeros",
       fast,
       all({-Real{0}, 0, 0, -Real{0}}),
       {{fast, "signs ignored", all({0, -Real{0}, -Real{0}, 0}), true}}},
      {"nan", "NaN comparisons", fast, {0, 1, 1, 0}, {{fast, "NaN ignored", {1, 0, 0, 1}, true}}},
      {"infinity", "2*max, 1/0, max < inf", fast, {bits(infinity), bits(-infinity), 1, 1}},
  };
}

bool is_nan(std::uint64_t bits, bool is_float) {
  return is_float ? bits <= 0xffffffff && std::isnan(std::bit_cast<float>(static_cast<std::uint32_t>(bits)))
                  : std::isnan(std::bit_cast<double>(bits));
}

// The results in the lines "NAME f32 HEX HEX …". A name that occurs twice, or in a line of another form, has no
// results.
std::map<std::string, std::vector<std::uint64_t>> results_in(std::string_view output) {
  std::map<std::string, std::vector<std::uint64_t>> results;
  std::istringstream lines{std::string(output)};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string canary, scalar;
    words >> canary >> scalar;
    const auto [at, is_first] = results.try_emplace(canary + ' ' + scalar);
    bool is_list = is_first;
    for (std::string word; is_list && words >> word;) {
      std::uint64_t number = 0;
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number, 16);
      is_list = error == std::errc() && end == word.data() + word.size();
      at->second.push_back(number);
    }
    if (!is_list) at->second.clear();
  }
  return results;
}

// Judges the bits of a result, and sets `rounding` and `found`.   in_excess: whether other canaries show registers
// whose width differs from the type's.
void judge(const Canary& canary, bool is_float, bool in_excess, CanaryResult& result) {
  const auto equal = [&](std::uint64_t found, const Expected& expected) {
    return expected ? found == *expected : is_nan(found, is_float);
  };
  const std::size_t count = canary.as_written.size();
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < count; ++i) wrong += !equal(result.bits[i], canary.as_written[i]);
  const auto set = [&](Rounding rounding, const std::string& words) {
    result.rounding = rounding;
    result.found = words;
  };
  if (wrong == 0) return set(Rounding::rounded, "as written");
  if (canary.name == "division" || canary.name == "root") {
    if (result.bits[1] != *canary.as_written[1] || result.bits[0] > result.bits[1])
      return set(Rounding::fast, "other bits");
    return set(in_excess ? Rounding::excess : Rounding::fast,
               fmt::format("{} of {} wrong", result.bits[0], result.bits[1]));
  }
  if (canary.name == "fma") return set(Rounding::fast, fmt::format("{} of {} wrong", wrong, count));
  // In these canaries, excess digits may look like regrouped terms.
  const bool has_both = canary.name.starts_with("sum") || canary.name == "subnormal_nearest";
  for (const Other& other : canary.others) {
    bool matches = true;
    for (std::size_t i = 0; i < count; ++i)
      matches = matches && (equal(result.bits[i], other.results[i]) ||
                            (other.partly && equal(result.bits[i], canary.as_written[i])));
    if (!matches || (other.rounding == Rounding::excess && has_both && !in_excess)) continue;
    // Wider registers give the same result as a fused operation.
    if (other.rounding == Rounding::contracted && in_excess) return set(Rounding::excess, "excess digits");
    return set(other.rounding, other.words);
  }
  set(Rounding::fast, "other bits");
}

}  // namespace

std::vector<CanaryResult> judge_canaries(std::string_view output) {
  const std::map<std::string, std::vector<std::uint64_t>> lines = results_in(output);
  std::vector<CanaryResult> results;
  for (const bool is_float : {true, false}) {
    const std::string scalar = is_float ? "f32" : "f64";
    const std::vector<Canary> all = is_float ? canaries<float>() : canaries<double>();
    const auto bits_of = [&](const Canary& canary) {
      const auto found = lines.find(canary.name + ' ' + scalar);
      return found != lines.end() && found->second.size() == canary.as_written.size() ? found->second
                                                                                      : std::vector<std::uint64_t>();
    };
    const auto result_of = [&](const Canary& canary, bool in_excess) {
      CanaryResult result{canary.name, scalar, canary.code, bits_of(canary), "no answer", std::nullopt};
      if (!result.bits.empty()) judge(canary, is_float, in_excess, result);
      return result;
    };
    // The canaries `range` and `nearest` distinguish wider registers from everything else.
    const bool in_excess = std::any_of(all.begin(), all.end(), [&](const Canary& canary) {
      return (canary.name == "range" || canary.name == "nearest") &&
             result_of(canary, false).rounding == Rounding::excess;
    });
    for (const Canary& canary : all) results.push_back(result_of(canary, in_excess));
  }
  return results;
}

std::optional<Rounding> measured_rounding(const std::vector<CanaryResult>& results) {
  Rounding most = Rounding::rounded;
  for (const CanaryResult& result : results) {
    if (!result.rounding) return std::nullopt;
    if (result.name != "fma") most = std::max(most, *result.rounding);
  }
  return most;
}

Documented compared(const CanaryResult& result, const Claim& claim) {
  if (!result.rounding) return Documented::no_claim;
  static const std::vector<Canary> all = canaries<float>();
  const Canary& canary =
      *std::find_if(all.begin(), all.end(), [&](const Canary& each) { return each.name == result.name; });
  if (!claim.contraction && *result.rounding == Rounding::contracted) return Documented::does_not_hold;
  const bool leaves_open = claim.rounding == Rounding::fast ||
                           (claim.rounding >= canary.least && (claim.across_statements || !canary.across));
  if (leaves_open && *result.rounding <= claim.rounding) return Documented::no_claim;
  return *result.rounding == Rounding::rounded ? Documented::holds : Documented::does_not_hold;
}

std::string_view name(Documented documented) {
  constexpr std::string_view kNames[] = {"holds", "does not hold", "no claim"};
  return kNames[static_cast<std::size_t>(documented)];
}

}  // namespace graze::subjects
