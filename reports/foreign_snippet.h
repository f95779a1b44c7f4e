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
  int seconds;           // time limit of the call
  std::string function;  // the user's __device__ function for a kernel; then `decide` includes its source
};

// For a program that nvcc compiles for a device.   Requires: a foreign CUDA lane.
ForeignCall kernel_call(const Lane& lane);

// For a program on the host. A CUDA lane is called through the graze command, which asks a device or the lane's twin.
// Requires: a foreign lane.
ForeignCall foreign_call(const Lane& lane, const AnyPair& pair, std::string_view compiler, std::string_view libraries);

}  // namespace graze::reports
