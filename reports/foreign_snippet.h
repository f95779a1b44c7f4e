// SPDX-License-Identifier: Apache-2.0
// What a program needs that shows a failure of a person's own code: how to build it, and a function that calls the
// code.
#pragma once

#include <string>

#include "core/lanes/lanes.h"
#include "core/pair.h"

namespace graze::reports {

// Whether there is a way to show the foreign lane: its subject was opened here.
bool shows_foreign(const Lane& lane);

struct ForeignCall {
  std::string command;   // compiles and runs case.cpp, or case.cu
  std::string decide;    // int decide(const Real* a, const Real* b): above 0 intersects, below 0 declined
  int seconds;           // for the call
  std::string function;  // of a kernel: __device__, as the user has it; then `decide` includes its source
};

// In a program for a device, by nvcc.   Requires: shows_foreign(lane), a CUDA lane.
ForeignCall kernel_call(const Lane& lane);

// On the host; a CUDA lane by the graze command, which asks a device or the lane's twin.   Requires:
// shows_foreign(lane).
ForeignCall foreign_call(const Lane& lane, const Pair& pair, std::string_view compiler, std::string_view libraries);

}  // namespace graze::reports
