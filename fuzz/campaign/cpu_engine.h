// SPDX-License-Identifier: Apache-2.0
// What the CPU engine does with pairs: all lanes, CGAL for every pair, GMP for every disagreement and a sample.
#pragma once

#include <functional>

#include "fuzz/campaign/campaign.h"

namespace graze::fuzz {

// Judges `count` pairs of the source, whose indices are index_of(0), index_of(1), …; on the threads at hand.
// Throws: OracleApart when two exact decisions differ.
BatchResult judge(const Campaign& campaign, int source, std::size_t count,
                  const std::function<std::uint64_t(std::size_t)>& index_of);

}  // namespace graze::fuzz
