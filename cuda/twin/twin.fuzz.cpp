// SPDX-License-Identifier: Apache-2.0
// On pairs of arbitrary bits, each twin without contraction must give the same verdict as the host lane.
#include "cuda/twin/twin.h"

#include "core/fuzz_pair.h"
#include "core/fuzz_target.h"
#include "core/lanes/lanes.h"

namespace graze::cuda {
namespace {

const RegisterFuzzTarget kTwin("twin", [](std::string_view bytes) {
  const Pair pair = pair_of(bytes);
  std::size_t compared = 0;
  for (const Lane& lane : lanes()) {
    if (lane.variant != Variant::cuda_nofma || !twin_row(lane).decide) continue;
    const Verdict twin = decide_one(twin_row(lane).decide, pair);
    must_hold(twin == decide_one(counterpart(lane, Variant::cpu)->decide, pair),
              "a twin without contraction decides as the host does");
    reached(4 * compared++ + static_cast<std::size_t>(twin));
  }
  must_hold(compared >= 10, "five algorithms in two precisions have a twin");
});

}  // namespace
}  // namespace graze::cuda
