// SPDX-License-Identifier: Apache-2.0
#include "cuda/subject/styles_testing.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "core/plain_file.h"

namespace graze::cuda {

namespace fs = std::filesystem;

void write_styles(const fs::path& styles, const fs::path& folder) {
  fs::remove_all(folder);
  fs::create_directories(folder);
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(styles)) {
    if (entry.path().extension() == ".cu") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::ofstream list(folder / "list");
  for (const fs::path& file : files) {
    for (const CudaBuild& build : build_cuda_subject(file, "intersects", {}, folder)) {
      if (build.twin.empty()) continue;
      const std::string stem = fmt::format("{}.{}", file.stem().string(), name(build.variant));
      std::ofstream(folder / (stem + ".ptx"), std::ios::binary) << build.ptx;
      list << fmt::format("{} {} {} {} {} {} {}\n", file.stem().string(), name(build.variant), name(build.scalar),
                          build.toolkit, build.hash, build.twin.filename().string(), build.machine_code_identical);
    }
  }
}

std::vector<StyleBuild> read_styles(const fs::path& folder) {
  std::vector<StyleBuild> all;
  std::ifstream list(folder / "list");
  std::string style, variant, scalar, toolkit, hash, twin, identical, why;
  while (list >> style >> variant >> scalar >> toolkit >> hash >> twin >> identical) {
    CudaBuild build{variant_of_name(variant).value(),
                    scalar == "f32" ? Scalar::f32 : Scalar::f64,
                    plain_file(folder / fmt::format("{}.{}.ptx", style, variant), why).value_or(""),
                    toolkit,
                    hash,
                    folder / twin,
                    "",
                    identical == "true"};
    all.push_back({fmt::format("{}/{}/{}", style, scalar, variant), std::move(build)});
  }
  return all;
}

}  // namespace graze::cuda
