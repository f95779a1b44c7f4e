// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace graze {

// An error in the user's request: graze exits with status 2, but with status 1 after any other error.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The message for a feature that builds by scripts/campaign leave out.
inline std::string not_in_a_campaigns_build(const std::string& what) {
  return what + ": not in this build, which scripts/campaign made; scripts/setup builds everything";
}

}  // namespace graze
