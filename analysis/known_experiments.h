// SPDX-License-Identifier: Apache-2.0
// Remembers experiments: one takes hundreds of verdicts, and a program may need a millisecond for each.
#pragma once

#include "analysis/experiments.h"

namespace graze::analysis {

// Like `experiment`, but for a lane in the lane table it returns the result that this process already has for the pair.
// Thread-safe.
Experiment known_experiment(const Lane& lane, Verdict verdict, const AnyPair& pair, Verdict truth);

}  // namespace graze::analysis
