// SPDX-License-Identifier: Apache-2.0
// Recognises Graze's own files and folders. Graze writes results only to new files or folders, or over its own results.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>

namespace graze::fuzz {

// Whether a result with this text may replace the file; symbolic links are followed. The file must be missing, empty, a
// device, a pipe, or written by Graze. Graze recognises its files by how they begin: by the first line or tag, a JSON
// object's first two keys, the start of a page's title, or the start of an ulp map's palette.
// Throws: std::runtime_error if the file cannot be read.
bool may_replace(const std::filesystem::path& file, const std::string& text);

// Why a file may not be replaced, and what to do.
inline constexpr const char* kForeign =
    "it does not begin like the file that Graze writes there; move it away, choose another name, or add --force";

// Set by --force for the whole process: even files that Graze did not write may be replaced.
inline bool may_replace_foreign = false;

// Throws: UsageError if the file has the name of a campaign's file, is in cases/ or is behind a link, but does not
// begin like this text. A file that is damaged only after its beginning may be replaced.
void expect_own(const std::filesystem::path& file, const std::string& text);

// Whether the file is left over from an interrupted write: its name ends in kPart.
bool is_left_over(const std::filesystem::path& file);

// Whether results may be written to the folder. The folder must be missing, hold one of the files `own`, or hold only
// empty folders and leftovers of killed writes.
bool may_fill(const std::filesystem::path& folder, std::initializer_list<const char*> own);

}  // namespace graze::fuzz
