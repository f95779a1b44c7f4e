// SPDX-License-Identifier: Apache-2.0
// Pairs of any bits: the exact decision, GMP's and CGAL's are the same, and the certified bounds of the margin hold the
// exact one, rounded once by MPFR.
#include <cmath>
#include <cstring>
#include <optional>

#include "core/exact/exact.h"
#include "core/fuzz_target.h"
#include "core/margin/margin.h"
#include "oracle/truth.h"

namespace graze::oracle {
namespace {

// First byte even: the 72 bytes that follow. Odd: small whole numbers, 18 bytes, times the power of two that the second
// byte says, so that contacts are common.
std::optional<Pair> pair_of(std::string_view bytes) {
  Pair pair;
  if (bytes.empty()) return std::nullopt;
  const bool raw = bytes[0] % 2 == 0;
  bytes.remove_prefix(1);
  if (bytes.size() < (raw ? sizeof pair : 19)) return std::nullopt;
  if (raw) {
    std::memcpy(&pair, bytes.data(), sizeof pair);
  } else {
    for (int i = 0; i < kCoordinates; ++i)
      coordinates(pair)[i] = std::ldexp(static_cast<float>(static_cast<signed char>(bytes[static_cast<std::size_t>(i) + 1])),
                                        static_cast<signed char>(bytes[0]));
  }
  return is_finite(pair) ? std::optional(pair) : std::nullopt;
}

const RegisterFuzzTarget kExact("exact", [](std::string_view bytes) {
  const std::optional<Pair> pair = pair_of(bytes);
  if (!pair) return;
  const bool exact = exact::intersects(coordinates(*pair), coordinates(*pair) + 9);
  must_hold(exact == (cgal_verdict(*pair) == Verdict::intersects), "the exact decision and CGAL's are the same");
  must_hold(exact == (gmp_contact(*pair) != Contact::none), "the exact decision and GMP's are the same");
});

const RegisterFuzzTarget kMargin("margin", [](std::string_view bytes) {
  const std::optional<Pair> pair = pair_of(bytes);
  if (!pair) return;
  const Truth truth = oracle::truth(*pair);
  const MarginBounds bounds = margin_bounds(*pair, truth.verdict);
  const double margin = std::fabs(truth.margin);
  must_hold(bounds.lo <= margin && margin <= bounds.hi, "the bounds hold the margin");
  must_hold((truth.verdict == Verdict::disjoint) == (truth.margin > 0), "the margin's sign says the verdict");
});

}  // namespace
}  // namespace graze::oracle
