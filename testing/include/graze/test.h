// SPDX-License-Identifier: Apache-2.0
// Tests a function that decides whether two triangles intersect, as part of your own project's tests. Pairs are drawn
// from Graze's strata, and their truth is exact. <graze/gtest.h>, <graze/catch2.h> and <graze/doctest.h> turn such a
// test into a test case. Needs C++20; the library, graze::test, depends only on the C++ standard library.
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

// Calls f with `count` pairs, divided evenly among the strata, in order. A pair depends only on the seed, the stratum
// and its index; it is the same on every machine. strata: names with * and ?, separated by commas; "!x" leaves out x;
// "*" is all. `graze strata` lists them. Throws: std::invalid_argument for a name that no stratum has.
void for_each_pair(std::string_view strata, std::uint64_t seed, std::uint64_t count,
                   const std::function<void(const Pair&)>& f);

// The relation of the closed triangles: verdict, dimension of their intersection, sign of the margin, dimension of each
// hull, and whether they are coplanar. Declined if a coordinate is not finite. Exact for every other pair.
Relation truth(const Pair& pair);

// Whether the true answer is required for a kind of pairs, or either answer is accepted.
enum Answer : bool { required, either };

struct TestOptions {
  std::string_view strata = "*";  // as in for_each_pair
  std::uint64_t pairs = 100'000;  // the environment variable GRAZE_PAIRS overrides it
  std::uint64_t seed = 1;         // the environment variable GRAZE_SEED overrides it
  double max_wrong = 0;           // the accepted share of wrong answers among all pairs, 0 to 1
  Answer touching = required;     // hulls that meet, but that a small motion separates
  Answer coplanar = required;     // all six vertices lie in one plane
  Answer degenerate = required;   // a triangle is a segment or a point
  Answer shared = required;       // a vertex of one is a vertex of the other
};

struct TestResult {
  bool passed = false;
  std::string message;  // why it failed; empty if it passed
  std::string summary;  // the message without the pair: how many answers are wrong, by stratum
  std::string fault;    // the error on the smallest pair: "it says disjoint, but the triangles meet in a point"
  std::uint64_t pairs = 0;
  Counts counts;                 // an exception counts as crashed
  std::optional<Pair> smallest;  // if it failed: a wrong pair, shrunk without changing truth or answer
};

// Tests the function on all pairs. overlap takes each triangle as three vertices x y z; it returns 0 for disjoint, a
// positive number for intersects, and a negative one for declined. name: the function's name, for the message. The test
// fails if more answers are wrong than `max_wrong` allows, if the function declines every pair, or if an option or
// environment variable is not valid. The result depends only on the arguments and those two environment variables.
TestResult test_overlap(std::string_view name, const std::function<int(const float*, const float*)>& overlap,
                        const TestOptions& options = {});

// Like test_overlap, for code that decides many pairs per call. `decide` sets the verdict of each of `count` pairs, at
// most 4096. A value that is not a verdict counts as crashed. An exception ends the test.
using DecidePairs = std::function<void(const Pair* pairs, std::size_t count, Verdict* verdicts)>;
TestResult test_pairs(std::string_view name, const DecidePairs& decide, const TestOptions& options = {});

// The error in the verdict on the pair, in words; empty if the verdict is accepted.
std::string fault_of(const Pair& pair, Verdict verdict, const TestOptions& options = {});

// Wraps f for test_overlap. f takes two triangles as arrays of float or double, const T a[9], and returns bool or int.
// If f takes doubles, they have exactly the floats' values.
template <class F>
std::function<int(const float*, const float*)> overlap_of(F f) {
  if constexpr (std::is_invocable_v<F&, const float(&)[9], const float(&)[9]>) {
    return [f](const float* a, const float* b) mutable {
      return static_cast<int>(f(*reinterpret_cast<const float(*)[9]>(a), *reinterpret_cast<const float(*)[9]>(b)));
    };
  } else {
    static_assert(std::is_invocable_v<F&, const double(&)[9], const double(&)[9]>,
                  "expected bool f(const float a[9], const float b[9]); int and double are accepted too");
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
