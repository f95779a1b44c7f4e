// SPDX-License-Identifier: Apache-2.0
// What the manuals of GCC and clang promise about the arithmetic of code that a command compiles.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "subjects/toolchains/toolchains.h"

namespace graze::subjects {

struct Claim {
  Rounding rounding = Rounding::rounded;  // the greatest freedom that the compiler has
  // Whether the compiler may fuse, or keep excess precision, across statements and calls.
  bool across_statements = true;
  std::string because = {};  // the reason, in words: "-ffp-contract=off"
  bool contraction = true;   // false: no contraction, although other rewriting is permitted
};

// The claim for code that the command compiles. Of opposite flags, the last one counts. If the manual can be read in
// two ways, the claim is the more permissive one.   macros: the command's output with -dM -E for an empty source.
// Returns: nothing for compilers other than GCC and clang.
std::optional<Claim> documented_claim(std::string_view command, std::string_view macros);

}  // namespace graze::subjects
