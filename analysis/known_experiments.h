// SPDX-License-Identifier: Apache-2.0
// Remembers experiments: one takes hundreds of verdicts, and a program may need a millisecond for each.
#pragma once

#include "analysis/experiments.h"

namespace graze::analysis {

// Like `experiment`; of a lane in the lane table, a result that this process had before for the pair is given again.
// Thread-safe.
Experiment known_experiment(const Lane& lane, Verdict verdict, const AnyPair& pair, Verdict truth);

}  // namespace graze::analysis
