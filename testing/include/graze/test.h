// SPDX-License-Identifier: Apache-2.0
// Tests a function that decides whether two triangles intersect, inside the tests of your own project. Pairs are drawn
// from Graze's strata, and their truth is exact. <graze/gtest.h>, <graze/catch2.h> and <graze/doctest.h> make test
// cases of it. C++20; the library, graze::test, needs the C++ standard library only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include <graze/counts.h>
#include <graze/pair.h>

namespace graze {

// Calls f with `count` pairs of the strata, in order. A pair depends on seed, stratum and its place alone; it is the
// same on every machine. The strata share the pairs evenly. strata: names with * and ?, separated by commas; "!x"
// leaves out x; "*" is all. `graze strata` lists them. Throws: std::invalid_argument for a name that no stratum has.
void for_each_pair(std::string_view strata, std::uint64_t seed, std::uint64_t count,
                   const std::function<void(const Pair&)>& f);

// How the closed triangles lie: verdict, dimension of what they share, sign of the margin, dimension of each hull,
// whether one plane holds all. Declined if a coordinate is not finite. Exact for every other pair.
Relation truth(const Pair& pair);

// For a kind of pairs: whether the true answer is required, or either one is accepted.
enum Answer : bool { required, either };

struct TestOptions {
  std::string_view strata = "*";  // as for for_each_pair
  std::uint64_t pairs = 100'000;  // the environment's GRAZE_PAIRS replaces it
  std::uint64_t seed = 1;         // the environment's GRAZE_SEED replaces it
  double max_wrong = 0;           // the share of wrong answers among all pairs that is accepted, 0 to 1
  Answer touching = required;     // hulls that meet in points or segments, which a small motion separates
  Answer coplanar = required;     // one plane holds all six vertices
  Answer degenerate = required;   // a triangle is a segment or a point
  Answer shared = required;       // a vertex of one is a vertex of the other
};

struct TestResult {
  bool passed = false;
  std::string message;  // why it failed; empty if it passed
  std::string summary;  // the part of the message without the pair: how many answers are wrong, by stratum
  std::string
      fault;  // what is wrong with the answer on the pair: "it says disjoint, but the triangles meet in a point"
  std::uint64_t pairs = 0;
  Counts counts;                 // an exception counts as crashed
  std::optional<Pair> smallest;  // where it failed: a wrong pair, shrunk while truth and answer stay
};

// Decides all pairs. overlap: three vertices x y z of each triangle; the answer is 0 for disjoint, above 0 for
// intersects, below 0 for declined. name: of the function, for the message. The test fails if more answers are wrong
// than `max_wrong` allows, if the function declines every pair, or if an option or the environment is not valid. The
// result depends on its arguments and the environment alone.
TestResult test_overlap(std::string_view name, const std::function<int(const float*, const float*)>& overlap,
                        const TestOptions& options = {});

// As test_overlap, for code that decides many pairs in a call. It sets the verdict of each of `count` pairs, at most
// 4096. A value that no verdict has counts as crashed. What it throws ends the test.
using DecidePairs = std::function<void(const Pair* pairs, std::size_t count, Verdict* verdicts)>;
TestResult test_pairs(std::string_view name, const DecidePairs& decide, const TestOptions& options = {});

// What is wrong with the verdict on the pair, in words; empty if it is accepted.
std::string fault_of(const Pair& pair, Verdict verdict, const TestOptions& options = {});

// The function as test_overlap takes it. f takes two triangles as float or double arrays, const T a[9], and returns
// bool or int. Doubles are the floats, exactly.
template <class F>
std::function<int(const float*, const float*)> overlap_of(F f) {
  if constexpr (std::is_invocable_v<F&, const float(&)[9], const float(&)[9]>) {
    return [f](const float* a, const float* b) mutable {
      return static_cast<int>(f(*reinterpret_cast<const float(*)[9]>(a), *reinterpret_cast<const float(*)[9]>(b)));
    };
  } else {
    static_assert(std::is_invocable_v<F&, const double(&)[9], const double(&)[9]>,
                  "expected bool f(const float a[9], const float b[9]), or int, or with double");
    return [f](const float* a, const float* b) mutable {
      double wide_a[9], wide_b[9];
      for (int i = 0; i < 9; ++i) {
        wide_a[i] = a[i];
        wide_b[i] = b[i];
      }
      const double(&first)[9] = wide_a, (&second)[9] = wide_b;
      return static_cast<int>(f(first, second));
    };
  }
}

}  // namespace graze
