// SPDX-License-Identifier: Apache-2.0
// A policy that compares exactly, and records every value that it compares and every choice.
#pragma once

#include <cstdint>

#include "core/epsilon_sites.h"
#include "core/verdict.h"

namespace graze {

inline constexpr int kMostQuestions = 64, kMostChoices = 15;

// Memory for the values of a run: value k of question q is at values[(2 q + k) * stride]. A question about one value
// uses only k = 0; a comparison of two values has the left one at k = 0 and the right one at k = 1.
template <class Real>
struct Recorded {
  Real* values;
  std::uint64_t stride;
};

// Bit q of `asked` is set if question q was asked. Bits 4 k to 4 k + 3 of `path` hold 1 + choice k, and bits 60
// to 63 hold 1 + the verdict.
struct RecordedPath {
  std::uint64_t asked = 0, path = 0;
};

inline constexpr std::uint64_t kChoices = ~std::uint64_t{0} >> 4;

GRAZE_HD inline Verdict recorded_verdict(std::uint64_t path) { return static_cast<Verdict>((path >> 60) - 1); }

inline namespace GRAZE_FP {

template <class Real>
struct Recording {
  Recorded<Real> to;
  RecordedPath* path;

  GRAZE_HD Real seen(int question, const Real& x) const {
    to.values[2 * static_cast<unsigned>(question) * to.stride] = x;
    path->asked |= std::uint64_t{1} << question;
    return x;
  }
  GRAZE_HD void keep(int question, const Real& l, const Real& r) const {
    seen(question, l);
    to.values[(2 * static_cast<unsigned>(question) + 1) * to.stride] = r;
  }

  GRAZE_HD Real snap(const At& at, const Real& x) const { return seen(at.question, x); }
  GRAZE_HD bool less(const At& at, const Real& l, const Real& r) const {
    keep(at.question, l, r);
    return l < r;
  }
  GRAZE_HD bool at_most(const At& at, const Real& l, const Real& r) const {
    keep(at.question, l, r);
    return l <= r;
  }
  GRAZE_HD int chosen(int which, int value) const {
    path->path |= static_cast<std::uint64_t>(value + 1) << 4 * which;
    return value;
  }
};

// Runs the algorithm on the triangles and records its values.
template <class Algorithm, class Real>
GRAZE_HD RecordedPath record(const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3], const Recorded<Real>& to) {
  RecordedPath path;
  const Verdict verdict = Algorithm::decide(a, b, Recording<Real>{to, &path});
  path.path |= (static_cast<std::uint64_t>(verdict) + 1) << 60;
  return path;
}

}  // namespace GRAZE_FP
}  // namespace graze
