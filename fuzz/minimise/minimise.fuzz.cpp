// SPDX-License-Identifier: Apache-2.0
// Runs the minimiser on failing pairs, with arbitrary bits or from any stratum. The minimiser must end within its
// limit. Its result must fail in the same way as the pair, for the stated reason, and be at most as complex.
#include "fuzz/minimise/minimise.h"

#include "core/fuzz_pair.h"
#include "core/fuzz_target.h"
#include "strata/strata.h"

namespace graze::fuzz {
namespace {

constexpr std::size_t kMost = kLeastMoved + 5'000;

// If the first byte is 255, the other bytes are a stratum and an index: the pairs that strata draw fail more often.
Pair drawn_or_given(std::string_view bytes) {
  if (bytes.size() != 5 || bytes[0] != '\xff') return finite_pair_of(bytes);
  std::uint64_t index = 0;
  for (const char c : bytes.substr(2)) index = index << 8 | static_cast<unsigned char>(c);
  return strata::generate(1, strata::kStrata[static_cast<unsigned char>(bytes[1]) % strata::kStrataCount].stratum,
                          index);
}

const RegisterFuzzTarget kMinimise("minimise", [](std::string_view bytes) {
  static const SelectedLanes under_test = select_lanes({"*/f32/cpu", "*/f32/cuda-fma"}, Executor::twin);
  const Pair pair = drawn_or_given(bytes);
  for (const Failure& failure : failures_of(under_test, pair)) {
    must_hold(fails_alike(failure, pair), "a pair fails like itself");
    if (!can_shrink(failure)) continue;
    const Minimised small = minimise(failure, pair, {}, kMost);
    must_hold(small.moved <= kMost, "the search ends within its limit");
    must_hold(fails_alike(failure, small.pair), "the result fails alike");
    must_hold(reason_of(failure, small.pair) == small.reason, "the reason is that of the result");
    must_hold(small.reason.cause == reason_of(failure, pair).cause, "the cause is that of the original pair");
    must_hold(simplicity(small.pair) <= simplicity(pair), "the result is at most as complex as the original");
    reached(static_cast<std::size_t>(small.reason.cause) * 64 +
            static_cast<std::size_t>(failure.lanes.front()->algorithm) * 4 + small.reason.in_range * 2 +
            small.one_minimal);
  }
});

}  // namespace
}  // namespace graze::fuzz
