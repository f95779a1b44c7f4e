// SPDX-License-Identifier: Apache-2.0
// The questions that each algorithm asks its policy, with numbers and stable names. Each algorithm's `list`, at the end
// of its struct, lists them in the order of their numbers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/epsilon_sites.h"

namespace graze {

struct Question {
  std::string
      name;    // "plane_distance.b[1]", "separation.normal_a: a.high < b.low", "separation.b.low in a: b.low <= a.high"
  int site;    // a Site; kSiteCount if the algorithm compares without an epsilon
  int degree;  // the unit of its values is a length to this power
  std::vector<std::string> of;  // the name of its value, or of its left and right values
  bool at_most = false;         // for two values: asks left <= right instead of left < right
};

// The name of a question's site; "own" for kSiteCount.
std::string_view site_name(int site);

// An algorithm's questions, in the order of their numbers.   Requires: an index into Algorithms.
const std::vector<Question>& questions_of(int algorithm);

// The degree of each question, for core/discrepancy/count.h.
std::vector<std::uint8_t> degrees_of(int algorithm);

}  // namespace graze
