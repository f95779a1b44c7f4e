// SPDX-License-Identifier: Apache-2.0
// Fuzz targets: functions that must get through any bytes. They stand beside what they test, as x.fuzz.cpp;
// fuzz/targets runs them under libFuzzer, core/fuzz_replay.test.cpp on the stored corpora alone.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

namespace graze {

struct FuzzTarget {
  const char* name;  // also of its folder in corpus/fuzz
  void (*one)(std::string_view bytes);
};

inline std::vector<FuzzTarget>& fuzz_targets() {
  static std::vector<FuzzTarget> targets;
  return targets;
}

struct RegisterFuzzTarget {
  RegisterFuzzTarget(const char* name, void (*one)(std::string_view)) { fuzz_targets().push_back({name, one}); }
};

// Ends the process where a target finds something that must hold and does not.
inline void must_hold(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "expected that %s\n", what);
  std::abort();
}

// What errors of readers must be: one line, and not empty.
inline void must_be_one_line(std::string_view error) {
  must_hold(!error.empty() && error.find('\n') == error.npos, "an error is one line");
}

}  // namespace graze
