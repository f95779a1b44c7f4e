// SPDX-License-Identifier: Apache-2.0
#include "oracle/precise.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "oracle/multiprecision.h"

namespace graze::oracle {
namespace {

int mantissa_bits(Scalar scalar) { return scalar == Scalar::f32 ? 24 : 53; }

// Sets MPFR's exponent range during its lifetime. 0.5 * 2^emin is the least positive number, and all numbers are below
// 2^emax. more: bits that mantissas have beyond the scalar's.
struct ExponentRange {
  mpfr_exp_t emin = mpfr_get_emin(), emax = mpfr_get_emax();

  ExponentRange(Scalar scalar, Limits limits, int more = 0) {
    if (limits.upper) mpfr_set_emax(scalar == Scalar::f32 ? 128 : 1024);
    if (limits.lower) mpfr_set_emin((scalar == Scalar::f32 ? -148 : -1073) - more);
    Multi::subnormals = limits.lower;
    Multi::first_event = 0;
  }
  ~ExponentRange() {
    mpfr_set_emin(emin);
    mpfr_set_emax(emax);
    Multi::subnormals = false;
  }
};

template <std::size_t... i>
Verdict decide_in_multi(int algorithm, const DoublePair& pair, std::index_sequence<i...>) {
  Vec3<Multi> a[3], b[3];
  for (int v = 0; v < 3; ++v) {
    a[v] = {Multi(pair.a[v].x), Multi(pair.a[v].y), Multi(pair.a[v].z)};
    b[v] = {Multi(pair.b[v].x), Multi(pair.b[v].y), Multi(pair.b[v].z)};
  }
  using Decide = Verdict (*)(const Vec3<Multi>(&)[3], const Vec3<Multi>(&)[3]);
  constexpr Decide kDecide[] = {[](const Vec3<Multi>(&p)[3], const Vec3<Multi>(&q)[3]) {
    return std::tuple_element_t<i, Algorithms>::decide(p, q);
  }...};
  return kDecide[algorithm](a, b);
}

Trace<Ball> run_exactly(int algorithm, const DoublePair& pair, int bits, const Path& lead = {}) {
  Multi::precision = bits;
  Ball::untold = 0;
  return run_traced<Ball>(algorithm, pair, lead);
}

Path outcomes_of(const Trace<Ball>& run) {
  Path outcomes;
  for (const Seen<Ball>& seen : run.seen) {
    if (seen.compared) outcomes.push_back(seen.held);
  }
  return outcomes;
}

// A precision in bits at which the error bounds separate any two unequal values of polynomials in the coordinates, up
// to degree kDegree. Quotients and roots of such polynomials may need more.
int separating_bits(const DoublePair& pair) {
  constexpr int kDegree = 16;
  int exponent = 0;
  for (std::size_t i = 0; i < kCoordinates; ++i) {
    if (coordinates(pair)[i] != 0) exponent = std::max(exponent, std::abs(std::ilogb(coordinates(pair)[i])));
  }
  return kDegree * (2 * exponent + std::numeric_limits<double>::digits);
}

// A run of the algorithm along a given path, with as many bits as it needs. Multi::precision keeps that number of bits.
struct SettledRun {
  Trace<Ball> run;
  Exactly exactly;
};
SettledRun run_settled(int algorithm, const DoublePair& pair, const Path& lead = {}) {
  Path last;
  long last_untold = 0;
  constexpr int kLeast = 256, kMost = 65536;
  const int separating = separating_bits(pair);
  for (int bits = kLeast;; bits *= 4) {
    Trace<Ball> run = run_exactly(algorithm, pair, bits, lead);
    const long untold = Ball::untold;
    const bool certain = untold == 0;
    const bool settled =
        certain || (bits > kLeast && bits >= separating && untold == last_untold && outcomes_of(run) == last);
    if (settled || bits == kMost) {
      const Verdict verdict = run.verdict;
      return {std::move(run), {verdict, bits, certain, settled}};
    }
    last = outcomes_of(run);
    last_untold = untold;
  }
}

Trace<Multi> run_multi(int algorithm, const DoublePair& pair, Contraction rule, const Path& lead) {
  if (rule == Contraction::nvcc) return run_traced<Multi, Contraction::nvcc>(algorithm, pair, lead);
  if (rule == Contraction::left) return run_traced<Multi, Contraction::left>(algorithm, pair, lead);
  return run_traced<Multi>(algorithm, pair, lead);
}

Beside beside(double lane, const Ball& exact, int bits) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const mpfr_srcptr x = exact.mid.get();
  if (!mpfr_nan_p(x) && exact.can_be_zero()) return {lane, 0, "0", lane == 0 ? 0 : kInfinity};
  char decimal[64];
  mpfr_snprintf(decimal, sizeof decimal, "%.6Rg", x);
  const double rounded = mpfr_get_d(x, MPFR_RNDN);
  if (!mpfr_number_p(x) || !std::isfinite(lane)) {
    const bool same = !mpfr_number_p(x) && (lane == rounded || (std::isnan(lane) && std::isnan(rounded)));
    return {lane, rounded, decimal, same ? 0 : kInfinity};
  }
  Multi error = Multi(lane) - exact.mid;
  mpfr_mul_2si(error.get(), error.get(), bits - static_cast<long>(mpfr_get_exp(x)), MPFR_RNDN);
  return {lane, rounded, decimal, std::abs(mpfr_get_d(error.get(), MPFR_RNDN))};
}

}  // namespace

Limited decide_limited(int algorithm, Scalar scalar, const DoublePair& pair, Limits limits) {
  const ExponentRange range(scalar, limits);
  Multi::precision = mantissa_bits(scalar);
  const Verdict verdict = decide_in_multi(algorithm, pair, std::make_index_sequence<kAlgorithmCount>());
  const int first = Multi::first_event;
  return {verdict, first > 0 ? RangeEvent::overflow : first < 0 ? RangeEvent::underflow : RangeEvent::none};
}

Trace<double> run_limited(int algorithm, Scalar scalar, const DoublePair& pair, Limits limits, Contraction rule,
                          const Path& lead) {
  const ExponentRange range(scalar, limits);
  Multi::precision = mantissa_bits(scalar);
  const Trace<Multi> run = run_multi(algorithm, pair, rule, lead);
  Trace<double> result{run.verdict, {}};
  for (const Seen<Multi>& s : run.seen) {
    result.seen.push_back({s.where, s.site, s.compared, s.comparison, mpfr_get_d(s.left.get(), MPFR_RNDN),
                           mpfr_get_d(s.right.get(), MPFR_RNDN), s.left_result, s.right_result, s.held, s.taken});
  }
  return result;
}

Verdict decide_with_bits(int algorithm, const DoublePair& pair, int bits) {
  Multi::precision = bits;
  return decide_in_multi(algorithm, pair, std::make_index_sequence<kAlgorithmCount>());
}

Verdict decide_with_bits(int algorithm, const DoublePair& pair, int bits, Scalar exponents) {
  const ExponentRange range(exponents, {true, true}, bits - mantissa_bits(exponents));
  return decide_with_bits(algorithm, pair, bits);
}

int bits_needed(int algorithm, const DoublePair& pair, Verdict verdict, int least) {
  int bits = kMostBits + 1;
  while (bits > least && decide_with_bits(algorithm, pair, bits - 1) == verdict) --bits;
  return bits > kMostBits ? 0 : bits;
}

Exactly decide_exactly(int algorithm, const DoublePair& pair) { return run_settled(algorithm, pair).exactly; }

Verdict decide_exactly_but(int algorithm, Scalar scalar, const DoublePair& pair, int bits, Limits limits) {
  const ExponentRange range(scalar, limits);
  return run_exactly(algorithm, pair, bits).verdict;
}

std::vector<ExactStep> exact_steps(int algorithm, Scalar scalar, const DoublePair& pair, const Trace<double>& run) {
  const Trace<Ball> exact = run_settled(algorithm, pair, path_of(run)).run;
  if (exact.seen.size() != run.seen.size()) throw std::logic_error("exact_steps: another algorithm's run");
  const int mantissa = mantissa_bits(scalar);
  std::vector<ExactStep> steps;
  for (std::size_t i = 0; i < run.seen.size(); ++i) {
    const Seen<double>& lane = run.seen[i];
    const Seen<Ball>& seen = exact.seen[i];
    steps.push_back({beside(lane.left, seen.left, mantissa), beside(lane.right, seen.right, mantissa),
                     beside(lane.left - lane.right, seen.left - seen.right, mantissa), seen.held});
  }
  return steps;
}

Path exact_outcomes(int algorithm, const DoublePair& pair, const Path& path) {
  return outcomes_of(run_settled(algorithm, pair, path).run);
}

}  // namespace graze::oracle
