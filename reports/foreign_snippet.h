// SPDX-License-Identifier: Apache-2.0
// What a program needs that shows a failure of a person's own code: how to build it, and a function that calls the code.
#pragma once

#include <string>

#include "core/lanes.h"
#include "core/pair.h"

namespace graze::reports {

// Whether there is a way to show the foreign lane: its subject was opened here.
bool shows_foreign(const Lane& lane);

struct ForeignCall {
  std::string command;  // compiles and runs case.cpp; libraries of the test are to be put in for @libraries@
  std::string decide;   // int decide(const Real* a, const Real* b): above 0 intersects, below 0 declined
  int seconds;          // for the call
};

// Requires: shows_foreign(lane).
ForeignCall foreign_call(const Lane& lane, const Pair& pair, std::string_view compiler, std::string_view libraries);

}  // namespace graze::reports
