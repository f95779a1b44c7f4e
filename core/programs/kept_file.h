// SPDX-License-Identifier: Apache-2.0
// Files that are built once and kept, with a checksum of their name and content as their last line. Whoever loads a
// shared object does not see that line.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace graze {

// Adds the line to `made` and gives it its name, in one step: nobody sees a part of it.   Throws: std::runtime_error.
void keep_file(const std::filesystem::path& made, const std::filesystem::path& kept);

// Returns: what was kept; nothing where the file is not there, or is not as it was kept.
std::optional<std::string> kept_content(const std::filesystem::path& kept);

}  // namespace graze
