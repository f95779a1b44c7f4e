// SPDX-License-Identifier: Apache-2.0
// JSON results that Graze reads again. The last key holds a checksum of all others, which detects damage. A checksum
// does not prevent deliberate changes, so readers also check that the counts are possible.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "fuzz/files.h"

namespace graze::fuzz {

// Parses the text as JSON. Returns a discarded value if it is not JSON, is nested more than 64 levels deep, or repeats
// a key within one object. Copying, comparing and writing deeper JSON could exhaust the stack.
nlohmann::ordered_json parse_shallow(const std::string& text);

// The object with its "checksum" as the last key: FNV-1a of its text without spaces, 16 hex digits.
nlohmann::ordered_json sealed(nlohmann::ordered_json json);

// The object in a sealed file, without its checksum; null if there is no file.
// remedy: the advice for a file that fails the check, such as "remove it".
// Throws: FormatError that names the file and the remedy; std::runtime_error if the file cannot be read.
nlohmann::ordered_json read_sealed(const std::filesystem::path& file, const std::string& remedy,
                                   NamedBy named_by = NamedBy::graze);

}  // namespace graze::fuzz
