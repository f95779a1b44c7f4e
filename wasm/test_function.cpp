// SPDX-License-Identifier: Apache-2.0
// Tests a JavaScript function with <graze/test.h>. test_function.js calls the exported function.
#include <graze/test.h>

extern "C" {
char* text();  // in module.cpp

// Sets the verdict of each pair. JavaScript implements this function.
[[clang::import_module("graze"), clang::import_name("decide")]] void decide_in_javascript(const graze::Pair* pairs,
                                                                                          std::size_t count,
                                                                                          graze::Verdict* verdicts);
}

namespace graze::wasm {
namespace {

TestResult result;
struct TestOut {
  std::int32_t passed, has_smallest;
  const char *summary, *fault;
  double pairs, false_positive, false_negative, declined, crashed, by_convention;
  Pair smallest;
} test_out;

}  // namespace

// Tests the function. The text has the function's name, a zero byte, and the strata. either: bits 0 to 3 accept both
// answers on touching, coplanar, degenerate and shared pairs.   Requires: strata that exist, 0 <= max_wrong <= 1.
extern "C" [[clang::export_name("test_function")]] const TestOut* test_function(std::uint64_t pairs, std::uint64_t seed,
                                                                                double max_wrong, int either) {
  const std::string name = text(), strata = text() + name.size() + 1;
  const auto answer = [&](int bit) { return Answer{(either >> bit & 1) != 0}; };
  result = test_pairs(name, decide_in_javascript,
                      {strata, pairs, seed, max_wrong, answer(0), answer(1), answer(2), answer(3)});
  const auto number = [](std::uint64_t count) { return static_cast<double>(count); };
  const Counts& counts = result.counts;
  test_out = {
      result.passed,          result.smallest.has_value(),   result.summary.c_str(),          result.fault.c_str(),
      number(result.pairs),   number(counts.false_positive), number(counts.false_negative),   number(counts.declined),
      number(counts.crashed), number(counts.by_convention),  result.smallest.value_or(Pair{})};
  return &test_out;
}

}  // namespace graze::wasm
