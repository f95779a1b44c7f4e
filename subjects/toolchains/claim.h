// SPDX-License-Identifier: Apache-2.0
// What the manuals of GCC and clang promise about the arithmetic of code that a command compiles.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "subjects/toolchains/toolchains.h"

namespace graze::subjects {

struct Claim {
  Rounding rounding = Rounding::rounded;  // the most that the compiler may do
  // Whether it may fuse, or keep excess precision, across statements and calls, or only within an expression.
  bool across_statements = true;
  std::string because = {};  // in words: "-ffp-contract=off"
  bool contraction = true;   // false: excluded, although other rewriting is permitted
};

// Returns: nothing for compilers other than GCC and clang. Among opposite flags the last one counts. If the
// manual allows two readings, the claim is the one that permits more.
// macros: what the command prints with -dM -E for a source without text.
std::optional<Claim> documented_claim(std::string_view command, std::string_view macros);

}  // namespace graze::subjects
