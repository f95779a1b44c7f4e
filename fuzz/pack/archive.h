// SPDX-License-Identifier: Apache-2.0
// One file that holds several: an SQLite Archive (the table `sqlar` of `sqlite3 -A`), with uncompressed files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace graze::fuzz {

struct PackedFile {
  std::string name;         // "campaign/summary.json": relative, without "." and ".."
  bool is_program = false;  // has permission to be run
  std::string bytes;
};

// Whether an archive may hold a file of this name: it leads into the folder that the archive is unpacked to, whatever
// that folder holds, and can be printed.
bool may_be_packed(std::string_view name);

// The same files give the same bytes.   Requires: names that may be packed, each once.
std::string archive_of(std::vector<PackedFile> files);

// Whether the file begins as an archive of Graze.
bool is_archive(const std::filesystem::path& file);

// The files, by name. An archive is input: names, kinds and sizes are checked, links are refused, and the files
// together are no larger than the archive, so one that repeats its pages cannot fill the disk. Throws: FormatError that
// names the file, for a damaged or a hostile one.
std::vector<PackedFile> read_archive(const std::filesystem::path& file);

// Writes the files into a new folder.   Throws: UsageError if something has its name; std::runtime_error.
void unpack(const std::vector<PackedFile>& files, const std::filesystem::path& folder);

}  // namespace graze::fuzz
