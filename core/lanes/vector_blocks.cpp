// SPDX-License-Identifier: Apache-2.0
// Separating axes (core/algorithms/separating_axes.h) with one pair in each vector lane. The verdict does not depend on
// the order of the axes, so the code tests all of them and need not branch. This file is compiled for each instruction
// set with Google Highway, which chooses the best one at run time. No operation is contracted.
#ifdef __wasm__
#include "core/lanes/vector_blocks.h"

namespace graze {
DecideBlock::Function vector_block(std::string_view, Scalar) { return nullptr; }
}  // namespace graze
#else

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/lanes/vector_blocks.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "core/algorithms/algorithms.h"
#include "core/decide_each.h"
#include "core/lanes/vector_blocks.h"

HWY_BEFORE_NAMESPACE();
namespace graze {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_MAX_BYTES >= 32 && !HWY_HAVE_SCALABLE

template <class Real>
struct AtOnce {
  using Tag = hn::CappedTag<Real, 64 / sizeof(Real)>;
  using V = hn::Vec<Tag>;
  using M = hn::Mask<Tag>;
  static constexpr Tag d{};
  static constexpr std::size_t kPairs = hn::MaxLanes(Tag{});

  struct Three {
    V x, y, z;
    friend HWY_INLINE Three operator-(const Three& u, const Three& v) {
      return {hn::Sub(u.x, v.x), hn::Sub(u.y, v.y), hn::Sub(u.z, v.z)};
    }
  };

  static HWY_INLINE V minor_of(V p, V q, V r, V s) { return hn::Sub(hn::Mul(p, q), hn::Mul(r, s)); }
  static HWY_INLINE Three cross(const Three& u, const Three& v) {
    return {minor_of(u.y, v.z, u.z, v.y), minor_of(u.z, v.x, u.x, v.z), minor_of(u.x, v.y, u.y, v.x)};
  }
  static HWY_INLINE V dot(const Three& u, const Three& v) {
    return hn::Add(hn::Add(hn::Mul(u.x, v.x), hn::Mul(u.y, v.y)), hn::Mul(u.z, v.z));
  }

  struct Range {
    V lo, hi;
    HWY_INLINE Range(const Three& direction, const Three (&v)[3]) : lo(dot(direction, v[0])), hi(lo) {
      for (int i = 1; i < 3; ++i) {
        const V t = dot(direction, v[i]);
        lo = hn::IfThenElse(hn::Lt(t, lo), t, lo);  // not Min, which treats NaN differently
        hi = hn::IfThenElse(hn::Gt(t, hi), t, hi);
      }
    }
  };

  static HWY_INLINE M separates(const Three& axis, const Three (&a)[3], const Three (&b)[3]) {
    const Range s(axis, a), t(axis, b);
    return hn::Or(hn::Lt(s.hi, t.lo), hn::Lt(t.hi, s.lo));
  }

  static HWY_INLINE M separated(const Three (&a)[3], const Three (&b)[3]) {
    const Three ea[3] = {a[1] - a[0], a[2] - a[1], a[0] - a[2]};
    const Three eb[3] = {b[1] - b[0], b[2] - b[1], b[0] - b[2]};
    const Three na = cross(ea[0], ea[1]), nb = cross(eb[0], eb[1]);
    M found = hn::Or(separates(na, a, b), separates(nb, a, b));
    for (int i = 0; i < 3 && !hn::AllTrue(d, found); ++i) {
      for (int j = 0; j < 3; ++j) found = hn::Or(found, separates(cross(ea[i], eb[j]), a, b));
    }
    for (int i = 0; i < 3 && !hn::AllTrue(d, found); ++i)
      found = hn::Or(found, hn::Or(separates(cross(na, ea[i]), a, b), separates(cross(nb, eb[i]), a, b)));
    return found;
  }

  // Bit i is set if no axis separates pair i.
  static HWY_INLINE std::uint64_t intersects(const Pair* pairs) {
    HWY_ALIGN Real columns[18][kPairs];
    for (std::size_t i = 0; i < kPairs; ++i) {
      for (int v = 0; v < 3; ++v) {
        const Vec3<float>&a = pairs[i].a[v], &b = pairs[i].b[v];
        columns[3 * v][i] = a.x, columns[3 * v + 1][i] = a.y, columns[3 * v + 2][i] = a.z;
        columns[3 * v + 9][i] = b.x, columns[3 * v + 10][i] = b.y, columns[3 * v + 11][i] = b.z;
      }
    }
    const auto vertex = [&](int v) HWY_ATTR {
      return Three{hn::Load(d, columns[3 * v]), hn::Load(d, columns[3 * v + 1]), hn::Load(d, columns[3 * v + 2])};
    };
    const Three a[3] = {vertex(0), vertex(1), vertex(2)}, b[3] = {vertex(3), vertex(4), vertex(5)};
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, hn::Not(separated(a, b)), bytes);
    return bytes[0] | std::uint64_t{bytes[1]} << 8;
  }
};

// Decides whole words.   Returns: how many pairs it decided.
template <class Real>
HWY_ATTR std::size_t decide_words(const Pair* pairs, std::size_t count, std::uint64_t* intersects) {
  constexpr std::size_t kPairs = AtOnce<Real>::kPairs;
  constexpr std::uint64_t kAll = (std::uint64_t{1} << kPairs) - 1;
  std::size_t decided = 0;
  for (; decided + 64 <= count; decided += 64) {
    std::uint64_t word = 0;
    for (std::size_t i = 0; i < 64; i += kPairs) word |= (AtOnce<Real>::intersects(pairs + decided + i) & kAll) << i;
    intersects[decided / 64] = word;
  }
  return decided;
}

#else

template <class Real>
std::size_t decide_words(const Pair*, std::size_t, std::uint64_t*) {
  return 0;
}

#endif

std::size_t floats(const Pair* pairs, std::size_t count, std::uint64_t* intersects) {
  return decide_words<float>(pairs, count, intersects);
}
std::size_t doubles(const Pair* pairs, std::size_t count, std::uint64_t* intersects) {
  return decide_words<double>(pairs, count, intersects);
}

}  // namespace HWY_NAMESPACE
}  // namespace graze
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace graze {
namespace {

HWY_EXPORT(floats);
HWY_EXPORT(doubles);

template <class Real>
void decide(const Pair* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  std::size_t decided;
  if constexpr (sizeof(Real) == 4)
    decided = HWY_DYNAMIC_DISPATCH(floats)(pairs, count, intersects);
  else
    decided = HWY_DYNAMIC_DISPATCH(doubles)(pairs, count, intersects);
  std::fill_n(declined, decided / 64, 0);
  decide_each(pairs + decided, count - decided, intersects + decided / 64, declined + decided / 64,
              [](const Pair& pair) { return decide_widened<SeparatingAxes, Real>(pair); });
}

}  // namespace

DecideBlock::Function vector_block(std::string_view algorithm, Scalar scalar) {
  if (algorithm != SeparatingAxes::kInfo.id) return nullptr;
  return scalar == Scalar::f32 ? decide<float> : decide<double>;
}

}  // namespace graze
#endif
#endif
