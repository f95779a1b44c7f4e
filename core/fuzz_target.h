// SPDX-License-Identifier: Apache-2.0
// Fuzz targets: functions that must handle any bytes. Each target is in a file x.fuzz.cpp next to the code under test.
// fuzz/targets runs them under libFuzzer; core/fuzz_replay.test.cpp runs them only on the stored corpora.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

namespace graze {

struct FuzzTarget {
  const char* name;  // also the name of its folder in corpus/fuzz
  void (*one)(std::string_view bytes);
};

inline std::vector<FuzzTarget>& fuzz_targets() {
  static std::vector<FuzzTarget> targets;
  return targets;
}

struct RegisterFuzzTarget {
  RegisterFuzzTarget(const char* name, void (*one)(std::string_view)) { fuzz_targets().push_back({name, one}); }
};

// Aborts the process unless the condition holds.
inline void must_hold(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "expected that %s\n", what);
  std::abort();
}

// Tells libFuzzer to keep the input, because it reached a feature that branch coverage does not show. libFuzzer finds
// these counters by the section's name.
__attribute__((used, section("__libfuzzer_extra_counters"))) inline std::uint8_t fuzz_counters[4096];
inline void reached(std::size_t feature) { fuzz_counters[feature % sizeof fuzz_counters] = 1; }

// A reader's error message must be one line and not empty.
inline void must_be_one_line(std::string_view error) {
  must_hold(!error.empty() && error.find('\n') == error.npos, "an error is one line");
}

}  // namespace graze
