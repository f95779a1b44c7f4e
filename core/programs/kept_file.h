// SPDX-License-Identifier: Apache-2.0
// Files that are built once and kept. A kept file's last line is a checksum of its name and content. The loader of
// shared objects ignores a checksum at a file's end.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace graze {

// Renames `made` to `kept`, replacing an old file.   Throws: std::runtime_error, after removing `made`.
void move_over(const std::filesystem::path& made, const std::filesystem::path& kept);

// Appends the checksum to `made`, then renames it to `kept`. No reader sees a partial file.   Throws: as move_over.
void keep_file(const std::filesystem::path& made, const std::filesystem::path& kept);

// Returns: the kept content; nothing if the file is missing or was changed.
std::optional<std::string> kept_content(const std::filesystem::path& kept);

}  // namespace graze
