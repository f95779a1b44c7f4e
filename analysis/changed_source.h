// SPDX-License-Identifier: Apache-2.0
// What a foreign lane's source says about a pair when it is built with a change (subjects/rebuilt.h).
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "core/lanes/lanes.h"

namespace graze::analysis {

struct DecidingNumber {
  std::string line;   // "mine.cpp:9", of the first number
  std::string words;  // "with 1e-36 in place of 1e-6f at mine.cpp:9 it is right"
  bool on_images;     // it is right on the pair's images too
};

// A small number of the source that decides: the code is right with a negligible number in its place, and also with
// 1e-9 times the number, because a negligible conversion factor can make products underflow. Prefers numbers that also
// decide on the pair's images: on one pair any change may be right by luck. If no number decides alone, tries all
// together. is_right, is_right_on_images: called with the changed code; the second only if the first holds.
// doubles: double also replaces float, and all numbers change together.
using IsRight = std::function<bool(const DecideBlock& block)>;
std::optional<DecidingNumber> deciding_number(const Lane& lane, const IsRight& is_right,
                                              const IsRight& is_right_on_images, bool doubles = false);

struct InitialValues {
  std::string words;
  bool differ;  // the verdict depends on the value; otherwise any value makes it right, and the compiler warns
};

// Whether the verdict depends on uninitialised variables: it becomes right if the compiler sets them to zero, or to a
// pattern. If both make it right, the reason may be the different machine code, which on an x87 rounds in other places.
// Then the compiler must also warn of such a variable.
// verdict_of: the verdict of the changed code.   Requires: the lane is wrong on the pair.
std::optional<InitialValues> by_initial_values(const Lane& lane, Verdict truth,
                                               const std::function<Verdict(const DecideBlock& block)>& verdict_of);

}  // namespace graze::analysis
