// SPDX-License-Identifier: Apache-2.0
// Tests that the stored PTX, from which builds without nvcc make the twins, equals nvcc's current output.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace graze::cuda {
namespace {

std::vector<std::string> lines_of(const std::string& path) {
  std::ifstream in(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// The first difference between the files, with a few lines of each file.
std::string difference(const std::vector<std::string>& stored, const std::vector<std::string>& made) {
  std::size_t at = 0;
  while (at < stored.size() && at < made.size() && stored[at] == made[at]) ++at;
  if (at == stored.size() && at == made.size()) return "";
  std::string text = "line " + std::to_string(at + 1) + " of " + std::to_string(stored.size()) + ":\n";
  for (std::size_t i = at < 3 ? 0 : at - 3; i < at; ++i) text += "   " + stored[i] + "\n";
  for (std::size_t i = at; i < std::min(at + 5, stored.size()); ++i) text += " - " + stored[i] + "\n";
  for (std::size_t i = at; i < std::min(at + 5, made.size()); ++i) text += " + " + made[i] + "\n";
  return text;
}

class StoredPtx : public testing::TestWithParam<const char*> {};

TEST_P(StoredPtx, IsWhatNvccWrites) {
  const std::string folder = GRAZE_STORED_PTX, file = std::string(GetParam()) + ".ptx";
  if (folder.empty()) GTEST_SKIP() << "built without nvcc";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "the repository has no PTX of this nvcc: " << folder;
  const std::string differs = difference(lines_of(folder + "/" + file), lines_of(GRAZE_GENERATED_DIR "/" + file));
  EXPECT_EQ(differs, "")
      << "core/ or cuda/lanes/kernels.cu changed: store the new PTX with the build target graze_update_ptx";
}

INSTANTIATE_TEST_SUITE_P(Variants, StoredPtx, testing::Values("cuda_fma", "cuda_nofma"),
                         [](const auto& row) { return std::string(row.param); });

TEST(StoredPtx, HasNoPathOfItsMachine) {
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(GRAZE_SOURCE_DIR "/cuda/ptx")) {
    if (entry.path().extension() != ".ptx") continue;
    ++files;
    for (const std::string& line : lines_of(entry.path()))
      ASSERT_EQ(line.find("\"/"), std::string::npos) << entry.path() << ": " << line;
  }
  EXPECT_GE(files, 2);
}

}  // namespace
}  // namespace graze::cuda
