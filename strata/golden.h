// SPDX-License-Identifier: Apache-2.0
// Golden hashes of each stratum's first 10,000 pairs at seed 1, for tests on host and device. If a hash changes, stored
// (seed, stratum, index) triples give different pairs.
#pragma once

#include <cstdint>

#include "core/fnv1a.h"
#include "strata/strata.h"

namespace graze::strata {

inline constexpr std::uint64_t kGoldenSeed = 1;
inline constexpr std::uint64_t kGoldenPairs = 10'000;

inline constexpr std::uint64_t kHashStart = fnv1a("");

// FNV-1a over the coordinates' bytes, least significant first on a little-endian machine. hash: the previous result.
template <class Real>
std::uint64_t hash_bits(const BasicPair<Real>& pair, std::uint64_t hash = kHashStart) {
  return fnv1a({reinterpret_cast<const char*>(&pair), sizeof pair}, hash);
}

// One hash per stratum, in the order of kStrata; scripts/update_generated writes the rows.
inline constexpr std::uint64_t kGoldenHashes[kStrataCount] = {
    0x6557cb3eb6a58bf2u,  // uniform
    0xa55dd4371dc8fac0u,  // thesis
    0xf9afa3c3fbfeed79u,  // near_vertex_face
    0xb5a1ceb9e4d4652du,  // near_edge_edge
    0xa3c829b02b905febu,  // near_vertex_edge
    0xa31eda6978c7fd34u,  // near_vertex_vertex
    0x55eddc1de2153e3eu,  // coplanar_lattice
    0x84101b2def5e4c4fu,  // coplanar_wide
    0x616c3241ac4801dbu,  // exact_contact
    0x64f30f10b75356b3u,  // coplanar_rounded
    0x7115b270880fe965u,  // parallel
    0x261a94565b427d7bu,  // sliver
    0x48fcb845722c1a67u,  // degenerate
    0x80a4ec27855c067bu,  // shared_vertex
    0xcc34f9a8d48d2d28u,  // shared_edge
    0x4255a5855603688eu,  // far_from_origin
    0x883979c266ef092cu,  // extreme_scale
    0x2ade04b9c6084f63u,  // mixed_scale
    0xb9af2272a9faaad8u,  // lattice
    0x2f9d6e3df044236cu,  // thesis_special
    0xd219147e92198826u,  // nested
};

}  // namespace graze::strata
