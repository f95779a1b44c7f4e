// SPDX-License-Identifier: Apache-2.0
// Which files and folders are Graze's own: results go where nothing is, or where Graze's own results are.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>

namespace graze::fuzz {

// Whether a result with this text may replace the file, seen through symbolic links: it is missing or empty, a device
// or a pipe, or Graze wrote it. Graze knows its files by what all of their kind have: the same first line, or first
// tag; of a JSON object the first two keys; of a page its title; of a picture of points its colours. Throws:
// std::runtime_error for a file that cannot be read.
bool may_replace(const std::filesystem::path& file, const std::string& text);

// Why a file may not be replaced, and what to do.
inline constexpr const char* kForeign =
    "it does not begin as the file that graze writes there; move it away, choose another name, or add --force";

// --force, for all of this process: foreign files may be replaced.
inline bool may_replace_foreign = false;

// Throws: UsageError for a file of a campaign's folder or of its cases/, or a file behind a link, that does not begin
// as this text does: Graze did not write it. Damaged further on, it may be replaced.
void expect_own(const std::filesystem::path& file, const std::string& text);

// Whether results may go into the folder: it is missing, has nothing but empty folders and what a killed write left, or
// has one of these files.
bool may_fill(const std::filesystem::path& folder, std::initializer_list<const char*> own);

}  // namespace graze::fuzz
