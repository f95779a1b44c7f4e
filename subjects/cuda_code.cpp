// SPDX-License-Identifier: Apache-2.0
#include "subjects/cuda_code.h"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/fnv1a.h"
#include "core/programs/kept_file.h"
#include "subjects/source_build.h"

namespace graze::subjects {

std::shared_ptr<const SealedCopy> twin_of(const cuda::CudaBuild& build) {
  if (build.twin.empty()) return nullptr;
  const std::optional<std::string> bytes = kept_content(build.twin);
  if (!bytes)
    throw std::runtime_error(fmt::format("{} changed after it was built; run the command again", build.twin.string()));
  return std::make_shared<SealedCopy>(build.twin.filename().string(), *bytes);
}

Code code_of(const cuda::CudaBuild& build, const Wanted& wanted, bool on_device,
             std::shared_ptr<const SealedCopy> twin) {
  Code code{"library", build.twin.string(), "", std::string(name(build.scalar)), wanted.timeout, wanted.memory};
  if (!on_device) {
    code.content = std::move(twin);
    return code;
  }
  const std::filesystem::path ptx = cache_folder() / fmt::format("{:016x}.ptx", fnv1a(build.ptx));
  write_atomically(ptx, build.ptx);
  code.kind = "device";
  code.what = ptx.string();
  code.content = std::make_shared<SealedCopy>(ptx.filename().string(), build.ptx);
  return code;
}

}  // namespace graze::subjects
