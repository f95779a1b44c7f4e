// SPDX-License-Identifier: Apache-2.0
// An array of triangles in its owner's layout: rows of nine floats with a stride, nine columns, or an indexed mesh. The
// array lies in host or device memory and can be read in either.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/vec3.h"

namespace graze::cuda {

enum class Layout : std::uint8_t { rows, columns, mesh };

struct TriangleArray {
  Layout layout = Layout::rows;
  const char* rows = nullptr;      // nine floats each
  const float* columns[9] = {};    // x, y, z of each vertex
  const char* vertices = nullptr;  // three floats each
  const char* faces = nullptr;     // three std::uint32_t each
  std::size_t stride = 36;         // bytes between consecutive rows, elements of a column, or faces
  std::size_t vertex_stride = 12;
  std::uint64_t vertex_count = 0;
  std::uint64_t count = 0;

  GRAZE_HD static float read(const char* at) { return *reinterpret_cast<const float*>(at); }

  // A face with a vertex index that is out of range gets NaN coordinates.
  GRAZE_HD void load(std::uint64_t i, float* t) const {
    if (layout == Layout::rows) {
      const char* row = rows + i * stride;
      for (int k = 0; k < 9; ++k) t[k] = read(row + 4 * k);
    } else if (layout == Layout::columns) {
      for (int k = 0; k < 9; ++k) t[k] = read(reinterpret_cast<const char*>(columns[k]) + i * stride);
    } else {
      for (int v = 0; v < 3; ++v) {
        const std::uint32_t place = *reinterpret_cast<const std::uint32_t*>(faces + i * stride + 4 * v);
        const bool there = place < vertex_count;
        const char* vertex = vertices + (there ? place : 0) * vertex_stride;
        for (int k = 0; k < 3; ++k) t[3 * v + k] = there ? read(vertex + 4 * k) : __builtin_nanf("");
      }
    }
  }

  bool packed() const { return layout == Layout::rows && stride == 36; }
};

}  // namespace graze::cuda
