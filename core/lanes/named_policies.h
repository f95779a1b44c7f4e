// SPDX-License-Identifier: Apache-2.0
// The policies that are one word, as the last part of a lane's name. All other policies are tolerances ("rel:8").
#pragma once

#include <algorithm>
#include <iterator>
#include <string_view>

namespace graze {

inline constexpr std::string_view kNamedPolicies[] = {"paper", "bound", "filtered"};

inline bool is_named_policy(std::string_view text) {
  return std::find(std::begin(kNamedPolicies), std::end(kNamedPolicies), text) != std::end(kNamedPolicies);
}

}  // namespace graze
