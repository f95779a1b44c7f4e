// SPDX-License-Identifier: Apache-2.0
// The parts of a program that shows a failure of a user's own code: the build command, and a function that calls the
// code.
#pragma once

#include <string>

#include "core/any_pair.h"
#include "core/lanes/lanes.h"

namespace graze::reports {

struct ForeignCall {
  std::string command;   // compiles and runs case.cpp, or case.cu
  std::string decide;    // int decide(const Real* a, const Real* b): above 0 intersects, below 0 declined
  int seconds;           // time limit of the call, in seconds
  std::string function;  // for a kernel: the user's __device__ function, whose source `decide` includes
};

// Returns the parts for a program that nvcc compiles for a device.   Requires: a foreign CUDA lane.
ForeignCall kernel_call(const Lane& lane);

// Returns the parts for a program on the host. The program calls a CUDA lane through the graze command, which runs the
// lane on a device or replays it on its twin.   Requires: a foreign lane.
ForeignCall foreign_call(const Lane& lane, const AnyPair& pair, std::string_view compiler, std::string_view libraries);

}  // namespace graze::reports
