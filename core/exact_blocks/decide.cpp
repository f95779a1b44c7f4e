// SPDX-License-Identifier: Apache-2.0
// This file is compiled for each instruction set with Google Highway, which chooses the best one at run time. For some
// sets the code is contracted and may round differently. Decisions beyond the error bound do not depend on rounding;
// all other decisions are exact.
#ifdef __wasm__
#include "core/exact_blocks/one_by_one.h"

namespace graze::exact {
void decide(const float* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  one_by_one(pairs, count, intersects, declined);
}
void decide(const double* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  one_by_one(pairs, count, intersects, declined);
}
const char* decide_target() { return "scalar"; }
}  // namespace graze::exact
#else

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/exact_blocks/decide.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <span>

#include "core/exact/exact.h"
#include "core/exact_blocks/decide.h"
#include "core/exact_blocks/one_by_one.h"

HWY_BEFORE_NAMESPACE();
namespace graze::exact {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_MAX_BYTES >= 32 && !HWY_HAVE_SCALABLE && HWY_NATIVE_FMA
#include "core/exact_blocks/vectors-inl.h"

#include "core/exact_blocks/doubles-inl.h"

constexpr std::size_t kChunk = 512;  // the most pairs in a chunk, from which a step gathers its pairs
template <class Real>
constexpr std::size_t kChunkOf = kChunk * sizeof(float) / sizeof(Real);  // a chunk has 36 KB
constexpr unsigned kAll = (1u << kAtOnce) - 1;
constexpr int kBitsOfDoubles = detail::kDoubleBits;

// Indices of pairs that wait for the next step.
struct Waiting {
  std::uint16_t pair[kChunk + kAtOnce];
  std::size_t count = 0;

  void add(unsigned which, const std::uint16_t* pairs) {
    for (; which != 0; which &= which - 1) pair[count++] = pairs[std::countr_zero(which)];
  }

  // Calls step(numbers, which) with kAtOnce pairs at a time. Copies of the last pair fill the last group; `which`
  // excludes them.
  template <class Step>
  void take(const Step& step) {
    for (std::size_t i = 0; i < kAtOnce && count > 0; ++i) pair[count + i] = pair[count - 1];
    for (std::size_t i = 0; i < count; i += kAtOnce) step(pair + i, (1u << std::min(kAtOnce, count - i)) - 1);
  }
};

template <class Real>
struct Chunk {
  const Real* pairs;
  std::uint64_t *intersects, *declined;  // must be zeros at first

  // number(i): the index of the i-th pair.
  template <class Number>
  HWY_INLINE CoordinatesOf<Real> side_by_side(const Number& number) const {
    const Real* where[kAtOnce];
    for (std::size_t i = 0; i < kAtOnce; ++i) where[i] = pairs + number(i) * kNumbers;
    return CoordinatesOf<Real>(where);
  }
  HWY_INLINE CoordinatesOf<Real> from(std::size_t first) const {
    return side_by_side([&](std::size_t i) HWY_ATTR { return first + i; });
  }
  HWY_INLINE CoordinatesOf<Real> at(const std::uint16_t* numbers) const {
    return side_by_side([&](std::size_t i) HWY_ATTR { return std::size_t{numbers[i]}; });
  }

  static void set(std::uint64_t* words, unsigned which, const std::uint16_t* numbers) {
    for (; which != 0; which &= which - 1) {
      const std::size_t number = numbers[std::countr_zero(which)];
      words[number / 64] |= std::uint64_t{1} << number % 64;
    }
  }
};

template <class Real>
HWY_ATTR void decide_chunk(const Chunk<Real>& chunk, std::size_t count) {
  Waiting last, open, small, middle, large, rest;
  const std::size_t side_by_side = count / kAtOnce * kAtOnce;
  for (std::size_t i = 0; i < side_by_side; i += kAtOnce) {
    const Filtered found = filter_all(chunk.from(i));
    chunk.intersects[i / 64] |= std::uint64_t{found.intersects} << i % 64;
    chunk.declined[i / 64] |= std::uint64_t{found.declined} << i % 64;
    for (unsigned left = kAll & ~(found.intersects | found.disjoint | found.declined); left != 0; left &= left - 1)
      open.pair[open.count++] = static_cast<std::uint16_t>(i + static_cast<std::size_t>(std::countr_zero(left)));
  }
  for (std::size_t i = side_by_side; i < count; ++i) last.pair[last.count++] = static_cast<std::uint16_t>(i);
  last.take([&](const std::uint16_t* numbers, unsigned which) HWY_ATTR {
    const Filtered found = filter_all(chunk.at(numbers));
    chunk.set(chunk.intersects, which & found.intersects, numbers);
    chunk.set(chunk.declined, which & found.declined, numbers);
    open.add(which & ~(found.intersects | found.disjoint | found.declined), numbers);
  });
  open.take([&](const std::uint16_t* numbers, unsigned which) HWY_ATTR {
    const CoordinatesOf<Real> pairs = chunk.at(numbers);
    const unsigned shared = share_vertex(pairs);
    chunk.set(chunk.intersects, which & shared, numbers);
    if ((which &= ~shared) == 0) return;
    const unsigned of_doubles = OnGrid(pairs, kBitsOfDoubles).within, of_both = OnGrid(pairs, kBitsOfBoth).within;
    small.add(which & of_doubles, numbers);
    middle.add(which & ~of_doubles & of_both, numbers);
    large.add(which & ~of_doubles & ~of_both, numbers);
  });
  small.take([&](const std::uint16_t* numbers, unsigned which) HWY_ATTR {
    chunk.set(chunk.intersects, which & ~separated<Double>(OnGrid(chunk.at(numbers), kBitsOfDoubles)), numbers);
  });
  middle.take([&](const std::uint16_t* numbers, unsigned which) HWY_ATTR {
    chunk.set(chunk.intersects, which & ~separated<DoubleAndInteger>(OnGrid(chunk.at(numbers), kBitsOfBoth)), numbers);
  });
  large.take([&](const std::uint16_t* numbers, unsigned which) HWY_ATTR {
    const Filtered found = filter_all<DoubleDouble>(chunk.at(numbers));
    chunk.set(chunk.intersects, which & found.intersects, numbers);
    rest.add(which & ~(found.intersects | found.disjoint), numbers);
  });
  for (const std::uint16_t& number : std::span(rest.pair).first(rest.count)) {
    const Real* const pair = chunk.pairs + number * kNumbers;
    Stage stage;
    if (detail::decide_unsure(pair, pair + 9, stage)) chunk.set(chunk.intersects, 1, &number);
  }
}

template <class Real>
HWY_ATTR void decide_in_chunks(const Real* pairs, std::size_t count, std::uint64_t* intersects,
                               std::uint64_t* declined) {
  std::fill_n(intersects, (count + 63) / 64, 0);
  std::fill_n(declined, (count + 63) / 64, 0);
  for (std::size_t first = 0; first < count; first += kChunkOf<Real>)
    decide_chunk<Real>({pairs + first * kNumbers, intersects + first / 64, declined + first / 64},
                       std::min(kChunkOf<Real>, count - first));
}

const char* target() { return hwy::TargetName(HWY_TARGET); }

#else

template <class Real>
void decide_in_chunks(const Real* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  one_by_one(pairs, count, intersects, declined);
}

const char* target() { return "scalar"; }

#endif

void decide_floats(const float* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  decide_in_chunks(pairs, count, intersects, declined);
}
void decide_doubles(const double* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  decide_in_chunks(pairs, count, intersects, declined);
}

}  // namespace HWY_NAMESPACE
}  // namespace graze::exact
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace graze::exact {

HWY_EXPORT(decide_floats);
HWY_EXPORT(decide_doubles);
HWY_EXPORT(target);

void decide(const float* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  if (count == 1) return one_by_one(pairs, count, intersects, declined);  // vectors pay off only for several pairs
  HWY_DYNAMIC_DISPATCH(decide_floats)(pairs, count, intersects, declined);
}

void decide(const double* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  if (count == 1) return one_by_one(pairs, count, intersects, declined);
  HWY_DYNAMIC_DISPATCH(decide_doubles)(pairs, count, intersects, declined);
}

const char* decide_target() { return HWY_DYNAMIC_DISPATCH(target)(); }

}  // namespace graze::exact
#endif
#endif
