// SPDX-License-Identifier: Apache-2.0
// For tests of vector code, which Google Highway compiles once for each instruction set.
#pragma once

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cstdint>

namespace graze {

// Calls check() once for each instruction set that this processor supports. During the call, vector code uses that set.
template <class Check>
void on_every_target(const Check& check) {
  const auto take = [](std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  };
  take(0);  // all instruction sets that the processor supports
  for (std::int64_t all = hwy::SupportedTargets() & HWY_TARGETS; all != 0; all &= all - 1) {
    SCOPED_TRACE(hwy::TargetName(all & -all));
    take(all & -all);
    check();
  }
  take(0);
}

}  // namespace graze
