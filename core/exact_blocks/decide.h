// SPDX-License-Identifier: Apache-2.0
// The exact decision for many pairs at once, in the processor's vector registers.
#pragma once

#include <cstddef>
#include <cstdint>

namespace graze::exact {

// Bit i % 64 of word i / 64 of `intersects`: whether the closed triangles of pair i share a point. The same bit of
// `declined`: whether a coordinate of pair i is not finite; the bit of `intersects` is then zero. pairs: 18 numbers
// each, x y z of a's vertices and then of b's. Bits beyond `count` become zero. Decides eight pairs at a time with
// AVX-512, four with AVX2, and one otherwise. A single pair goes to intersects() of core/exact/exact.h.
// Exact: always.
void decide(const float* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined);
void decide(const double* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined);

// The instruction set that decide uses on this processor: "AVX3", "AVX2", …, or "scalar".
const char* decide_target();

}  // namespace graze::exact
