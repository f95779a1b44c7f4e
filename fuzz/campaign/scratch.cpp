// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/scratch.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "core/cannot.h"
#include "core/fnv1a.h"
#include "fuzz/files.h"

namespace graze::fuzz {

namespace fs = std::filesystem;

namespace {

// In /tmp another user could guess the folder's name and create it first.
// Throws: std::runtime_error if the folder is a link, or belongs to another user.
void expect_own_folder(const fs::path& folder) {
  struct stat there {};
  if (lstat(folder.c_str(), &there) != 0) throw std::runtime_error(cannot("use", folder, errno));
  if (!S_ISDIR(there.st_mode) || there.st_uid != geteuid())
    throw std::runtime_error(
        cannot("use", folder, "it is a link, or belongs to another user; remove it, or choose another --scratch"));
}

}  // namespace

fs::path scratch_of(const fs::path& disk, const fs::path& directory) {
  return disk / fmt::format("graze-{:016x}", fnv1a(fs::absolute(directory).lexically_normal().string()));
}

void fetch_from_directory(const Campaign& campaign) {
  const auto make = [](const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw std::runtime_error(cannot("make the directory", folder, error.message()));
  };
  make(campaign.scratch);
  expect_own_folder(campaign.scratch);
  make(campaign.directory);
  const FolderLock alone(campaign.scratch, FolderLock::WhenTaken::refuse);
  make(campaign.scratch);  // again, because a process that ended while this one waited may have removed it
  expect_own_folder(campaign.scratch);
  if (fs::exists(campaign.scratch / kDatabase) || !fs::exists(campaign.directory / kDatabase)) return;
  copy_whole(campaign.directory / kDatabase, campaign.scratch / kDatabase);
}

void bring_to_directory(const Campaign& campaign) {
  copy_whole(campaign.scratch / kDatabase, campaign.directory / kDatabase);
  remove_store(campaign.scratch);
}

}  // namespace graze::fuzz
