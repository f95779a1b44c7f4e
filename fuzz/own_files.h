// SPDX-License-Identifier: Apache-2.0
// Recognises Graze's own files and folders. Results go only to empty places or replace Graze's own results.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>

namespace graze::fuzz {

// Whether a result with this text may replace the file, seen through symbolic links. The file must be missing, empty, a
// device, a pipe, or written by Graze. Graze recognises its files by what all of their kind share: the first line or
// tag, or the first two keys of a JSON object. Pages share the start of their title, and pictures of ulp maps the start
// of their palette.
// Throws: std::runtime_error for a file that cannot be read.
bool may_replace(const std::filesystem::path& file, const std::string& text);

// Why a file may not be replaced, and what to do.
inline constexpr const char* kForeign =
    "it does not begin as the file that graze writes there; move it away, choose another name, or add --force";

// Set by --force for the whole process: files that Graze did not write may be replaced.
inline bool may_replace_foreign = false;

// Throws: UsageError if Graze did not write the file: it belongs to a campaign's folder or its cases/, or is behind a
// link, and its beginning differs from this text's. A file that is damaged further on may be replaced.
void expect_own(const std::filesystem::path& file, const std::string& text);

// Whether a killed write left the file, under a name that is Graze's own.
bool is_left_over(const std::filesystem::path& file);

// Whether results may go into the folder: it is missing, holds nothing but empty folders and leftovers of a killed
// write, or holds one of the files `own`.
bool may_fill(const std::filesystem::path& folder, std::initializer_list<const char*> own);

}  // namespace graze::fuzz
