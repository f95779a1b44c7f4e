// SPDX-License-Identifier: Apache-2.0
// Replays the stored corpora of the linked fuzz targets. This test needs no clang and is part of every build.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/fuzz_target.h"

namespace graze {
namespace {

namespace fs = std::filesystem;

TEST(FuzzTargets, GetThroughTheirStoredCorpora) {
  ASSERT_FALSE(fuzz_targets().empty());
  for (const FuzzTarget& target : fuzz_targets()) {
    const fs::path folder = fs::path(GRAZE_SOURCE_DIR) / "corpus/fuzz" / target.name;
    ASSERT_TRUE(fs::is_directory(folder)) << folder;
    std::vector<fs::path> files{fs::directory_iterator(folder), fs::directory_iterator()};
    std::sort(files.begin(), files.end());
    EXPECT_GE(files.size(), 2u) << folder;
    for (const fs::path& file : files) {
      std::ifstream in(file, std::ios::binary);
      const std::string bytes{std::istreambuf_iterator<char>(in), {}};
      target.one(bytes);  // aborts if a must_hold condition fails
      for (const std::size_t length : {bytes.size() / 2, bytes.size() - std::min<std::size_t>(bytes.size(), 1)})
        target.one(std::string_view(bytes).substr(0, length));
    }
  }
}

}  // namespace
}  // namespace graze
