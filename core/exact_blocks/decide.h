// SPDX-License-Identifier: Apache-2.0
// The exact decision of many pairs, side by side in the processor's vectors.
#pragma once

#include <cstddef>
#include <cstdint>

namespace graze::exact {

// Bit i % 64 of word i / 64 of `intersects`: whether the closed triangles of pair i share a point; of `declined`:
// whether one of its coordinates is not finite, and then the other bit is zero. A pair is 18 floats, x y z of a's
// vertices and then of b's, one pair after the other. Bits of the last words beyond `count` become zero. Exact: always,
// as intersects() of core/exact/exact.h, which decides one pair. Eight pairs at a time where the processor has AVX-512,
// four with AVX2, else one by one.
void decide(const float* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined);

// The instruction set that it uses here: "AVX3", "AVX2", …, or "scalar".
const char* decide_target();

}  // namespace graze::exact
