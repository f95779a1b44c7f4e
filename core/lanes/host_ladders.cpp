// SPDX-License-Identifier: Apache-2.0
// This file is compiled like the host lanes of the variant cpu: in their namespace and with their flags.
#include <algorithm>
#include <array>
#include <vector>

#include "core/algorithms/algorithms.h"
#include "core/lanes/decide_under.h"
#include "core/lanes/ladder.h"

namespace graze {
inline namespace GRAZE_FP {

// Decides like rung `at`, and finds the next rung on which some comparison of this decision has a different outcome. On
// the rungs in between, all outcomes and therefore the verdict are the same.
template <class Real>
class Climb {
 public:
  Climb(const std::vector<Tolerances<Real>>& rungs, std::size_t at) : rungs_(rungs), at_(at), next_(rungs.size()) {}

  std::size_t next() const { return next_; }

  template <class Number>
  bool near_zero(Site site, const Number& x) const {
    if (rungs_[at_].near_zero(site, x)) return true;
    // Tolerances do not decrease. So among rungs at_ + 1 to next_ - 1, those that treat x as zero are the last ones.
    if (next_ - at_ > 1 && rungs_[next_ - 1].near_zero(site, x)) {
      std::size_t far = at_;
      while (next_ - far > 1) {
        const std::size_t middle = far + (next_ - far) / 2;
        (rungs_[middle].near_zero(site, x) ? next_ : far) = middle;
      }
    }
    return false;
  }

  // The functions of a policy, with the same results as in Tolerances.
  template <class Number>
  Number snap(Site site, const Number& x) const {
    return near_zero(site, x) ? Number(0) : x;
  }
  template <class Number>
  bool less(Site site, const Number& l, const Number& r) const {
    return l < r && !near_zero(site, r - l);
  }
  template <class Number>
  bool at_most(Site site, const Number& l, const Number& r) const {
    return l <= r || near_zero(site, l - r);
  }

 private:
  const std::vector<Tolerances<Real>>& rungs_;
  std::size_t at_;
  mutable std::size_t next_;
};

template <class Algorithm, class Real, class Number, class PairOf>
void decide_ladder(std::span<const Epsilons> epsilons, const PairOf* pairs, std::size_t count,
                   std::uint64_t* intersects, std::uint64_t* declined) {
  const std::vector<Tolerances<Real>> rungs(epsilons.begin(), epsilons.end());
  const std::size_t words = (count + 63) / 64;
  std::fill_n(intersects, words * rungs.size(), 0);
  std::fill_n(declined, words * rungs.size(), 0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t bit = std::uint64_t{1} << i % 64;
    Vec3<Number> p[3], q[3];
    for (int v = 0; v < 3; ++v) {
      p[v] = {Number(Real(pairs[i].a[v].x)), Number(Real(pairs[i].a[v].y)), Number(Real(pairs[i].a[v].z))};
      q[v] = {Number(Real(pairs[i].b[v].x)), Number(Real(pairs[i].b[v].y)), Number(Real(pairs[i].b[v].z))};
    }
    Verdict before = Verdict::disjoint;
    for (std::size_t at = 0; at < rungs.size();) {
      const Climb<Real> climb(rungs, at);
      const Verdict verdict = Algorithm::decide(p, q, climb);
      // Marks the rungs whose bit differs from the previous rung's; the last loop turns these marks into bits.
      std::uint64_t& yes = intersects[at * words + i / 64];
      std::uint64_t& no_answer = declined[at * words + i / 64];
      if ((verdict == Verdict::intersects) != (before == Verdict::intersects)) yes |= bit;
      if ((verdict == Verdict::declined) != (before == Verdict::declined)) no_answer |= bit;
      before = verdict;
      at = climb.next();
    }
  }
  for (std::size_t k = words; k < words * rungs.size(); ++k) {
    intersects[k] ^= intersects[k - words];
    declined[k] ^= declined[k - words];
  }
}

template <class Algorithm, class Number>
constexpr Ladders ladders_in_double() {
  return {decide_ladder<Algorithm, double, Number, Pair>, decide_ladder<Algorithm, double, Number, DoublePair>};
}

// The ladders of each algorithm, in this order: f32 absolute, f32 relative, f64 absolute, f64 relative.
template <class... Algorithm>
constexpr auto ladders(const std::tuple<Algorithm...>*) {
  return std::array{std::array<Ladders, 4>{Ladders{decide_ladder<Algorithm, float, float, Pair>},
                                           Ladders{decide_ladder<Algorithm, float, WithMagnitude<float>, Pair>},
                                           ladders_in_double<Algorithm, double>(),
                                           ladders_in_double<Algorithm, WithMagnitude<double>>()}...};
}

}  // namespace GRAZE_FP

Ladders ladders_of(const Lane& lane, bool relative) {
  static constexpr auto kLadders = ladders(static_cast<const Algorithms*>(nullptr));
  if (lane.variant != Variant::cpu || lane.algorithm < 0) return {};
  return kLadders[static_cast<std::size_t>(lane.algorithm)][static_cast<std::size_t>(lane.scalar) * 2 + relative];
}

}  // namespace graze
