// SPDX-License-Identifier: Apache-2.0
// JSON results that Graze reads again: the last key is a checksum of all others, so a change of any part is noticed.
// Whoever changes a file on purpose can compute it too; counts are therefore checked as well, by those who read them.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "fuzz/files.h"

namespace graze::fuzz {

// The JSON of the text; discarded if it is none or more than 64 levels deep. Copying, comparing and writing deeper JSON
// could exhaust the stack.
nlohmann::ordered_json parse_shallow(const std::string& text);

// The object with its "checksum" as the last key: FNV-1a of its text without spaces, 16 hex digits.
nlohmann::ordered_json sealed(nlohmann::ordered_json json);

// The object of a sealed file, without its checksum; null where there is no file.
// remedy: what to do about a file that does not check, "remove it".
// Throws: FormatError that names the file and the remedy; std::runtime_error for one that cannot be read.
nlohmann::ordered_json read_sealed(const std::filesystem::path& file, const std::string& remedy,
                                   NamedBy named_by = NamedBy::graze);

}  // namespace graze::fuzz
