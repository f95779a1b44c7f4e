// SPDX-License-Identifier: Apache-2.0
// One file that holds several files, uncompressed: an SQLite Archive (the table `sqlar` of `sqlite3 -A`).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace graze::fuzz {

struct PackedFile {
  std::string name;         // "campaign/summary.json": relative, without "." and ".."
  bool is_program = false;  // whether the file is executable
  std::string bytes;
};

// Whether an archive may hold a file with this name. The name must be printable and lead to a place inside the folder
// to which the archive is unpacked, whatever that folder contains.
bool may_be_packed(std::string_view name);

// An archive with these files; its bytes depend only on them.   Requires: distinct names that may be packed.
std::string archive_of(std::vector<PackedFile> files);

// Whether the file begins like an archive that Graze wrote.
bool is_archive(const std::filesystem::path& file);

// The files, sorted by name. An archive is untrusted input: names, kinds and sizes are checked, and links are refused.
// The files together must not be larger than the archive: if they shared its pages, they could fill the disk.
// Throws: FormatError that names the file, if it is damaged or hostile.
std::vector<PackedFile> read_archive(const std::filesystem::path& file);

// Writes the files into a new folder.   Throws: UsageError if the folder's name is taken; std::runtime_error.
void unpack(const std::vector<PackedFile>& files, const std::filesystem::path& folder);

}  // namespace graze::fuzz
