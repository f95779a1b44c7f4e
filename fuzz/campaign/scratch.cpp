// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/scratch.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>

#include "core/cannot.h"
#include "core/fnv1a.h"
#include "fuzz/files.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;

// Copies the file so that its target is whole or missing, even after a crash of the machine.
void copy_whole(const fs::path& from, const fs::path& to) {
  const fs::path part = to.string() + ".part";
  expect_file(from);
  std::error_code error;
  fs::remove(part, error);  // of a killed run; a link of this name may lead to a foreign file
  if (!error) fs::copy_file(from, part, error);
  const int file = error ? -1 : open(part.c_str(), O_RDONLY | O_CLOEXEC);
  if (!error && (file < 0 || fsync(file) != 0)) error = {errno, std::generic_category()};
  if (file >= 0) close(file);
  if (!error) fs::rename(part, to, error);
  if (error) throw std::runtime_error(cannot("write", to, error.message()));
}

}  // namespace

fs::path scratch_of(const fs::path& disk, const fs::path& directory) {
  return disk / fmt::format("graze-{:016x}", fnv1a(fs::absolute(directory).lexically_normal().string()));
}

void fetch_from_directory(const Campaign& campaign) {
  std::error_code error;
  for (const fs::path& folder : {campaign.scratch, campaign.directory}) {
    fs::create_directories(folder, error);
    if (error) throw std::runtime_error(cannot("make the directory", folder, error.message()));
  }
  const FolderLock alone(campaign.scratch, FolderLock::WhenTaken::refuse);
  if (fs::exists(campaign.scratch / kDatabase) || !fs::exists(campaign.directory / kDatabase)) return;
  copy_whole(campaign.directory / kDatabase, campaign.scratch / kDatabase);
}

void bring_to_directory(const Campaign& campaign) {
  copy_whole(campaign.scratch / kDatabase, campaign.directory / kDatabase);
  remove_store(campaign.scratch);
}

}  // namespace graze::fuzz
