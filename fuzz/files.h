// SPDX-License-Identifier: Apache-2.0
// Reads and writes whole files, and locks folders. A file is written under a temporary name and then renamed, so a
// reader never sees a partial file.
#pragma once

#include <filesystem>
#include <string>

namespace graze::fuzz {

// Who chose a file's name. A user may name a pipe or a device; names that Graze chooses are always files.
enum class NamedBy { graze, user };

// The suffix of a temporary file, which is in the final file's folder, and of a merge's temporary folder.
inline constexpr const char* kPart = ".graze.part";

// Throws: std::runtime_error if this name, after following symbolic links, is a pipe, a device or a folder.
void expect_file(const std::filesystem::path& file);

// The file's bytes; empty if there is no file.   Throws: std::runtime_error if the file cannot be read, or is a pipe or
// device that yields more than 64 MiB.
std::string read_whole(const std::filesystem::path& file, NamedBy named_by = NamedBy::graze);

// Writes the file, following symbolic links, or writes to a device or a pipe that the user named. Leaves no partial
// file if it fails. If two processes write the same file at once, each writes a whole file, and the one that is renamed
// last remains. Throws: std::runtime_error if `file` is a folder, or if there is no space.
void write_whole(const std::filesystem::path& file, const std::string& text, NamedBy named_by = NamedBy::graze);

// Copies the file. The copy is whole or missing, even after the machine crashes.   Throws: the errors of write_whole.
void copy_whole(const std::filesystem::path& from, const std::filesystem::path& to);

// Follows symbolic links to the file or folder that they point to, even if it does not exist yet.
std::filesystem::path behind_links(std::filesystem::path file);

// Holds the folder's lock as long as the object lives. No other process, and no other part of this process, can take
// the lock. A shared lock excludes only exclusive locks.
class FolderLock {
 public:
  enum class WhenTaken { wait, refuse, share };  // share: takes a shared lock; fails if an exclusive one is held

  // Throws: std::runtime_error if the folder does not exist, or if the lock is taken and when_taken is not `wait`.
  explicit FolderLock(const std::filesystem::path& folder, WhenTaken when_taken);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int handle_;
};

}  // namespace graze::fuzz
