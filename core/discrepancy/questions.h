// SPDX-License-Identifier: Apache-2.0
// The questions that each algorithm asks its policy, by number, with stable names. Each algorithm lists its questions
// in the order of their numbers, in `list` at the end of its struct.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/epsilon_sites.h"

namespace graze {

struct Question {
  std::string
      name;    // "plane_distance.b[1]", "separation.normal_a: a.high < b.low", "separation.b.low in a: b.low <= a.high"
  int site;    // a Site; kSiteCount: the source itself compares
  int degree;  // the unit of its values is a length to this power
  std::vector<std::string> of;  // the names of its values: one, or the left and the right one
  bool at_most = false;         // for two values: asks left <= right instead of left < right
};

// The name of a question's site; "own" for kSiteCount.
std::string_view site_name(int site);

// By number.   Requires: an index into Algorithms.
const std::vector<Question>& questions_of(int algorithm);

// The degree of each question, for core/discrepancy/count.h.
std::vector<std::uint8_t> degrees_of(int algorithm);

}  // namespace graze
