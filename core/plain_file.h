// SPDX-License-Identifier: Apache-2.0
// Reads files without ever waiting, neither for the writer of a pipe nor for a file without data yet, such as
// /proc/kmsg. By the time a file is opened, its name may refer to anything.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace graze {

// The file's bytes; or nothing, with the reason in `why`, if it cannot be read, is not a regular file, or has more than
// `most` bytes.   Throws: Stopped, when a stop is requested.
std::optional<std::string> plain_file(const std::filesystem::path& file, std::string& why,
                                      std::size_t most = std::size_t{1} << 30);

// The first bytes of a regular file, at most `most`; empty if it cannot be read.
std::string beginning_of(const std::filesystem::path& file, std::size_t most);

}  // namespace graze
