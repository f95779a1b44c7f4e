// SPDX-License-Identifier: Apache-2.0
// Reads files whose names may lead anywhere by the time they are opened, without ever waiting: not for the writer of a
// pipe, and not for a file that has nothing to give yet, such as /proc/kmsg.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace graze {

// The file's bytes; nothing with the reason in `why` if it cannot be read, is not a regular file, or has more than
// `most` bytes.   Throws: Stopped, when a stop is requested.
std::optional<std::string> plain_file(const std::filesystem::path& file, std::string& why,
                                      std::size_t most = std::size_t{1} << 30);

// The first bytes of such a file, at most `most`; none of one that cannot be read.
std::string beginning_of(const std::filesystem::path& file, std::size_t most);

}  // namespace graze
