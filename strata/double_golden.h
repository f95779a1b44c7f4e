// SPDX-License-Identifier: Apache-2.0
// Golden hashes of the strata of doubles, like those of float32 in strata/golden.h.
#pragma once

#include "strata/golden.h"

namespace graze::strata {

// One hash per stratum, in the order of kDoubleStrata; scripts/update_generated writes the rows.
inline constexpr std::uint64_t kDoubleGoldenHashes[kDoubleStrataCount] = {
    0x853c94276727cc61u,  // uniform
    0x4312f08de0a5f780u,  // thesis
    0xa6eb0de7f1d98abfu,  // near_vertex_face
    0xc0cd0c8222ffe95du,  // near_edge_edge
    0xa34722700ea30583u,  // near_vertex_edge
    0xd12a513e0b5da449u,  // near_vertex_vertex
    0xa7fdde59855d0101u,  // coplanar_lattice
    0x8651580d26976d6eu,  // coplanar_wide
    0x53bf65b19c6995dbu,  // exact_contact
    0x34c4cb1974fe5d95u,  // coplanar_rounded
    0x299c8a1f833ebdaeu,  // parallel
    0x7b5abea19e018ccau,  // sliver
    0x9fa7d1c47834ea52u,  // degenerate
    0x6b719f6883ce2a62u,  // shared_vertex
    0xf3a47fcbed54d449u,  // shared_edge
    0xadc7b3854f853d23u,  // far_from_origin
    0x57beb285b7b05b60u,  // extreme_scale
    0x39402482dd73800du,  // mixed_scale
    0x1df3b99ad56d5038u,  // lattice
    0xdeb8b00b163b0383u,  // thesis_special
    0x1ace45051e449906u,  // nested
    0xa37bc30d3493e0a3u,  // lattice_15
    0xe77e38867ce4f538u,  // large_offset
    0x47f7c50794aacbdau,  // float_born
    0x0ef156de8e865c0eu,  // decimal_born
    0xfa43b9230c856a10u,  // construction_born
    0xdf68eeadfd24602cu,  // stored
    0x63a79285b693958eu,  // radians
};

}  // namespace graze::strata
