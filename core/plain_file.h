// SPDX-License-Identifier: Apache-2.0
// Reads files without blocking: does not wait for a pipe's writer or for a file that has no data yet (/proc/kmsg).
// Callers cannot rule out such files, because a name may refer to another file by the time it is opened.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace graze {

// The file's bytes. Returns nothing, with the reason in `why`, if the file cannot be read, is not a regular file, or
// has more than `most` bytes.   Throws: Stopped, when a stop is requested.
std::optional<std::string> plain_file(const std::filesystem::path& file, std::string& why,
                                      std::size_t most = std::size_t{1} << 30);

// The first bytes of a regular file, at most `most`; empty if it cannot be read.
std::string beginning_of(const std::filesystem::path& file, std::size_t most);

}  // namespace graze
