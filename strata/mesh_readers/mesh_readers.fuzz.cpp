// SPDX-License-Identifier: Apache-2.0
// For any bytes, the mesh readers must return finite vertices and valid triangles, or give a one-line error.
#include <cmath>
#include <stdexcept>

#include "core/fuzz_target.h"
#include "strata/mesh_readers/soup.h"

namespace graze::strata {
namespace {

template <Soup (*read)(const MeshBytes&)>
void read_any(std::string_view bytes) {
  try {
    const Soup soup = read({"mesh", bytes});
    for (const Vec3<float>& v : soup.vertices)
      must_hold(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z), "vertices are finite");
    for (const auto& triangle : soup.triangles) {
      for (const std::uint32_t vertex : triangle) must_hold(vertex < soup.vertices.size(), "vertices exist");
    }
  } catch (const std::runtime_error& error) {
    must_be_one_line(error.what());
  }
}

const RegisterFuzzTarget kTargets[] = {
#define GRAZE_MESH_FORMAT(extension, name) {"mesh_" #extension, read_any<read_##extension>},
#include "strata/mesh_readers/formats.inc"
#undef GRAZE_MESH_FORMAT
};

}  // namespace
}  // namespace graze::strata
