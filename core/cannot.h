// SPDX-License-Identifier: Apache-2.0
// Error messages that end with the system's reason: "cannot write out/summary.json: No space left on device".
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

namespace graze {

inline std::string cannot(std::string_view act, const std::filesystem::path& on, const std::string& why) {
  return "cannot " + std::string(act) + ' ' + on.string() + ": " + why;
}

// error: an errno value.
inline std::string cannot(std::string_view act, const std::filesystem::path& on, int error) {
  return cannot(act, on, std::generic_category().message(error));
}

}  // namespace graze
