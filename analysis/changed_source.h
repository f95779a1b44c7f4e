// SPDX-License-Identifier: Apache-2.0
// Finds the cause of a wrong verdict by changing and rebuilding a foreign lane's source (subjects/rebuilt.h).
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "core/lanes/lanes.h"

namespace graze::analysis {

struct DecidingNumber {
  std::string line;   // the line of the first number, such as "mine.cpp:9"
  std::string words;  // "with 1e-36f in place of 1e-6f at mine.cpp:9 it is right"
  bool on_images;     // whether the changed code is right on the pair's images too
};

// Finds a small number in the source that decides the verdict. The code must be right with a negligible number in its
// place. It must also be right with 1e-9 times the number, because a negligible conversion factor can make products
// underflow. Prefers numbers that also decide on the pair's images, because on one pair any change may make the code
// right by luck. If no single number decides, changes all numbers together. is_right, is_right_on_images: called with
// the changed code; the second only if the first returns true.
// doubles: also replaces float by double, and changes all numbers together.
using IsRight = std::function<bool(const DecideBlock& block)>;
std::optional<DecidingNumber> deciding_number(const Lane& lane, const IsRight& is_right,
                                              const IsRight& is_right_on_images, bool doubles = false);

struct InitialValues {
  std::string words;
  bool differ;  // whether the verdict depends on the value; if not, any value makes it right, and the compiler warns
};

// Finds whether the verdict depends on uninitialised variables: whether it becomes right if the compiler sets them to
// zero or to a pattern. If both make it right, the reason may be the changed machine code, which on an x87 rounds in
// other places; so in that case the compiler must also warn of an uninitialised variable.
// verdict_of: the verdict of the changed code.   Requires: the lane is wrong on the pair.
std::optional<InitialValues> by_initial_values(const Lane& lane, Verdict truth,
                                               const std::function<Verdict(const DecideBlock& block)>& verdict_of);

}  // namespace graze::analysis
