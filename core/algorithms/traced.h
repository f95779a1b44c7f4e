// SPDX-License-Identifier: Apache-2.0
// Numbers and a policy that record an algorithm's comparisons and the values that it passes to the policy, each with
// its source line. These numbers can also force the outcomes of comparisons, so that the algorithm takes a given path.
#pragma once

#include <cmath>
#include <compare>
#include <cstdint>
#include <optional>
#include <source_location>
#include <span>
#include <tuple>
#include <type_traits>
#include <vector>

#include "core/algorithms/algorithms.h"
#include "core/pair.h"

namespace graze {

enum class Comparison : std::uint8_t { less, at_most, equal, greater, at_least };

constexpr bool holds(Comparison comparison, std::partial_ordering order) {
  switch (comparison) {
    case Comparison::less:
      return order < 0;
    case Comparison::at_most:
      return order <= 0;
    case Comparison::equal:
      return order == 0;
    case Comparison::greater:
      return order > 0;
    default:
      return order >= 0;
  }
}

// A comparison, or a value passed to the policy's snap (as `left`; `right` is zero).
template <class Number>
struct Seen {
  std::source_location where;
  std::optional<Site> site;  // the site passed to the policy; none if the algorithm itself compares
  bool compared;
  Comparison comparison;
  Number left, right;
  int left_result, right_result;  // indices of the run's results, from 0; -1 for a coordinate or a constant
  bool held;                      // the outcome according to the values
  bool taken;                     // the outcome that the algorithm got: `held`, unless a path forced it
};

// Outcomes of a run's comparisons, in order.
using Path = std::vector<bool>;

template <class Number>
struct Trace {
  Verdict verdict = Verdict::declined;
  std::vector<Seen<Number>> seen;
};

template <class Number>
Path path_of(const Trace<Number>& run) {
  Path path;
  for (const Seen<Number>& seen : run.seen) {
    if (seen.compared) path.push_back(seen.taken);
  }
  return path;
}

// A run in progress. Floats are stored as doubles, so the runs of all lanes have the same type.
template <class Number>
struct Recorder {
  using Kept = std::conditional_t<std::is_same_v<Number, float>, double, Number>;

  Trace<Kept> run;
  Path lead;  // forced outcomes of the first comparisons; the values decide later ones
  std::size_t comparisons = 0;
  int results = 0;
  std::vector<int> uses;        // how many additions use each product
  std::vector<int> known_uses;  // the same, from an earlier run

  static inline thread_local Recorder* current = nullptr;

  template <class Operand>  // a value and its result's index
  bool compare(Comparison comparison, const Operand& l, const Operand& r, std::optional<Site> site,
               const std::source_location& where) {
    const bool held = holds(comparison, order(l.value, r.value));
    const bool taken = comparisons < lead.size() ? lead[comparisons] : held;
    ++comparisons;
    run.seen.push_back({where, site, true, comparison, Kept(l.value), Kept(r.value), l.result, r.result, held, taken});
    return taken;
  }
  template <class Operand>
  void ask(Site site, const Operand& x, const std::source_location& where) {
    run.seen.push_back({where, site, false, Comparison::equal, Kept(x.value), Kept(0), x.result, -1, true, true});
  }

 private:
  static std::partial_ordering order(float l, float r) { return l <=> r; }
  static std::partial_ordering order(double l, double r) { return l <=> r; }
  template <class Other>
  static std::partial_ordering order(const Other& l, const Other& r) {
    return compare_numbers(l, r);
  }
};

// `none`: every operation rounds. `left`, `nvcc`: a sum or difference fuses a product with the addition. If both terms
// are products, `left` fuses the left one, as g++ does; `nvcc` fuses the one with fewer uses, or the left one on a tie,
// as in cuda/twin/generator/contraction.cpp. `nvcc` fuses neither if both multiply by a quotient: nvcc moves such an
// addition to another block (only in interval_overlap's common_line). These rules can be wrong: compare with the lane.
enum class Contraction { none, left, nvcc };

inline namespace GRAZE_FP {

template <class Number, Contraction contraction = Contraction::none>
struct Traced {
  Number value;
  int result = -1;                        // index among the run's results
  Number x{0}, y{0};                      // the factors, if it is a product
  int product = -1;                       // index among the run's products
  bool quotient = false, scaled = false;  // a quotient or a constant; a product with a quotient

  Traced() : value(0) {}
  explicit Traced(Number v) : value(std::move(v)) {}
  template <class Other>
  requires(std::is_arithmetic_v<Other> && !std::is_same_v<Other, Number>) explicit Traced(Other v)
      : value(static_cast<Number>(v)), quotient(std::is_integral_v<Other>) {}

  // A comparison's operand, and its place in the source.
  struct Operand {
    const Traced& number;
    std::source_location where;
    Operand(const Traced& n, std::source_location w = std::source_location::current()) : number(n), where(w) {}
  };

  friend Traced operator+(const Traced& l, const Traced& r) {
    if constexpr (contraction != Contraction::none) {
      using std::fma;
      const int fused = choose(l, r);
      if (fused < 0) return computed(fma(l.x, l.y, r.value));
      if (fused > 0) return computed(fma(r.x, r.y, l.value));
    }
    return computed(l.value + r.value);
  }
  friend Traced operator-(const Traced& l, const Traced& r) {
    if constexpr (contraction != Contraction::none) {
      using std::fma;
      const int fused = choose(l, r);
      if (fused < 0) return computed(fma(l.x, l.y, -r.value));
      if (fused > 0) return computed(fma(-r.x, r.y, l.value));
    }
    return computed(l.value - r.value);
  }
  friend Traced operator*(const Traced& l, const Traced& r) {
    Traced product = computed(l.value * r.value);
    if constexpr (contraction != Contraction::none) {
      product.x = l.value;
      product.y = r.value;
      product.scaled = r.quotient;
      product.product = static_cast<int>(Recorder<Number>::current->uses.size());
      Recorder<Number>::current->uses.push_back(0);
    }
    return product;
  }
  friend Traced operator/(const Traced& l, const Traced& r) {
    Traced ratio = computed(l.value / r.value);
    ratio.quotient = true;
    return ratio;
  }
  friend Traced operator-(const Traced& n) { return computed(-n.value); }
  friend Traced sqrt(const Traced& n) {
    using std::sqrt;
    return computed(sqrt(n.value));
  }

  friend bool operator<(Operand l, Operand r) { return compare(Comparison::less, l, r); }
  friend bool operator<=(Operand l, Operand r) { return compare(Comparison::at_most, l, r); }
  friend bool operator==(Operand l, Operand r) { return compare(Comparison::equal, l, r); }
  friend bool operator>(Operand l, Operand r) { return compare(Comparison::greater, l, r); }
  friend bool operator>=(Operand l, Operand r) { return compare(Comparison::at_least, l, r); }

 private:
  static Traced computed(Number value) {
    Traced number(std::move(value));
    number.result = Recorder<Number>::current->results++;
    return number;
  }
  // Which operand of an addition is fused: -1 the left, 1 the right, 0 neither.
  static int choose(const Traced& l, const Traced& r) {
    Recorder<Number>& recorder = *Recorder<Number>::current;
    const auto uses = [&recorder](const Traced& n) {
      if (n.product < 0) return 0;
      const auto i = static_cast<std::size_t>(n.product);
      ++recorder.uses[i];
      return i < recorder.known_uses.size() ? recorder.known_uses[i] : 1;
    };
    const int left = uses(l), right = uses(r);
    if (l.product < 0 || r.product < 0) return l.product >= 0 ? -1 : r.product >= 0 ? 1 : 0;
    if (contraction == Contraction::left) return -1;
    return l.scaled && r.scaled ? 0 : right < left ? 1 : -1;
  }
  static bool compare(Comparison comparison, const Operand& l, const Operand& r) {
    return Recorder<Number>::current->compare(comparison, l.number, r.number, std::nullopt, l.where);
  }
};

// A policy that compares exactly, like ExactZero, and records every question.
struct TracingPolicy {
  template <class Number, Contraction contraction>
  Traced<Number, contraction> snap(Site site, const Traced<Number, contraction>& n,
                                   std::source_location where = std::source_location::current()) const {
    Recorder<Number>::current->ask(site, n, where);
    Traced<Number, contraction> snapped(n.value);
    snapped.result = n.result;
    return snapped;
  }
  template <class Number, Contraction contraction>
  bool less(Site site, const Traced<Number, contraction>& l, const Traced<Number, contraction>& r,
            std::source_location where = std::source_location::current()) const {
    return Recorder<Number>::current->compare(Comparison::less, l, r, site, where);
  }
  template <class Number, Contraction contraction>
  bool at_most(Site site, const Traced<Number, contraction>& l, const Traced<Number, contraction>& r,
               std::source_location where = std::source_location::current()) const {
    return Recorder<Number>::current->compare(Comparison::at_most, l, r, site, where);
  }
};

// Runs the algorithm (an index into Algorithms) on the pair, rounded to Number, and forces it to take the path.
template <class Number, Contraction contraction = Contraction::none, class Coordinate>
Trace<typename Recorder<Number>::Kept> run_traced(int algorithm, const BasicPair<Coordinate>& pair,
                                                  const Path& lead = {}) {
  using Real = Traced<Number, contraction>;
  const auto run = [&]<std::size_t... i>(Recorder<Number> & recorder, std::index_sequence<i...>) {
    recorder.lead = lead;
    Recorder<Number>::current = &recorder;
    Vec3<Real> a[3], b[3];
    for (int v = 0; v < 3; ++v) {
      a[v] = {Real(pair.a[v].x), Real(pair.a[v].y), Real(pair.a[v].z)};
      b[v] = {Real(pair.b[v].x), Real(pair.b[v].y), Real(pair.b[v].z)};
    }
    const auto decide = [&]<std::size_t place>(std::integral_constant<std::size_t, place>) {
      if (static_cast<std::size_t>(algorithm) == place)
        recorder.run.verdict = std::tuple_element_t<place, Algorithms>::decide(a, b, TracingPolicy{});
    };
    (decide(std::integral_constant<std::size_t, i>()), ...);
    Recorder<Number>::current = nullptr;
  };
  Recorder<Number> recorder;
  run(recorder, std::make_index_sequence<kAlgorithmCount>());
  if constexpr (contraction != Contraction::none) {  // only a whole run shows how often each product is used
    Recorder<Number> again;
    again.known_uses = std::move(recorder.uses);
    run(again, std::make_index_sequence<kAlgorithmCount>());
    return std::move(again.run);
  }
  return std::move(recorder.run);
}

}  // namespace GRAZE_FP
}  // namespace graze
