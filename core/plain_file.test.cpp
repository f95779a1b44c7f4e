// SPDX-License-Identifier: Apache-2.0
#include "core/plain_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "core/stop.h"

namespace graze {
namespace {

namespace fs = std::filesystem;

class PlainFile : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  std::string why_not(const fs::path& file, std::size_t most = 1 << 20) {
    std::string why;
    EXPECT_FALSE(plain_file(file, why, most)) << file;
    return why;
  }
  const fs::path folder_ = fs::temp_directory_path() / ("graze_plain_" + std::to_string(getpid()));
};

TEST_F(PlainFile, HasItsBytes) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{5}, std::size_t{1} << 20, (std::size_t{1} << 21) + 3}) {
    std::string bytes(size, '\0'), why;
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * 7 % 251);
    std::ofstream(folder_ / "file", std::ios::binary) << bytes;
    EXPECT_EQ(plain_file(folder_ / "file", why, size), bytes);
    EXPECT_EQ(why, "");
    fs::create_symlink("file", folder_ / "link");
    EXPECT_EQ(plain_file(folder_ / "link", why, size), bytes);
    fs::remove(folder_ / "link");
    EXPECT_EQ(beginning_of(folder_ / "file", 18), bytes.substr(0, 18));
  }
  EXPECT_EQ(beginning_of(folder_, 18), "");
}

// plain_file must not block on any of these files.
TEST_F(PlainFile, SaysWhyItCannotBeRead) {
  EXPECT_EQ(why_not(folder_ / "missing"), "No such file or directory");
  EXPECT_EQ(why_not(folder_), "Is a directory");
  EXPECT_EQ(why_not("/dev/zero"), "it is not a regular file");
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(why_not(folder_ / "pipe"), "it is not a regular file");
  std::ofstream(folder_ / "large").close();
  fs::resize_file(folder_ / "large", (1 << 20) + 1);
  EXPECT_EQ(why_not(folder_ / "large"), "it is larger than 1 MiB");
  if (std::ifstream("/proc/kmsg")) {  // only root can open it; it looks like a regular file, but never ends
    EXPECT_NE(why_not("/proc/kmsg"), "");
  }
}

TEST_F(PlainFile, Stops) {
  std::ofstream(folder_ / "file") << "text";
  std::string why;
  stop_requested = true;
  EXPECT_THROW(plain_file(folder_ / "file", why), Stopped);
  stop_requested = false;
}

}  // namespace
}  // namespace graze
