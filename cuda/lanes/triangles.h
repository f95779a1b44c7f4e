// SPDX-License-Identifier: Apache-2.0
// An array of triangles in its owner's layout: rows of nine coordinates with a stride, nine columns, or an indexed
// mesh. The array is in host memory or in device memory. The type does not tell whether the coordinates are floats or
// doubles; the caller of `load` must know.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/vec3.h"

namespace graze::cuda {

enum class Layout : std::uint8_t { rows, columns, mesh };

struct TriangleArray {
  Layout layout = Layout::rows;
  const char* rows = nullptr;      // rows of nine coordinates
  const char* columns[9] = {};     // x, y, z of each vertex
  const char* vertices = nullptr;  // vertices of three coordinates
  const char* faces = nullptr;     // faces of three indices, each a std::uint32_t
  std::size_t stride = 36;         // bytes between consecutive rows, elements of a column, or faces
  std::size_t vertex_stride = 12;
  std::uint64_t vertex_count = 0;
  std::uint64_t count = 0;

  template <class Real>
  GRAZE_HD static Real read(const char* at) {
    return *reinterpret_cast<const Real*>(at);
  }

  // Reads triangle i. A vertex whose index is out of range becomes NaN.   Requires: Real is the coordinates' type.
  template <class Real>
  GRAZE_HD void load(std::uint64_t i, Real* t) const {
    if (layout == Layout::rows) {
      const char* row = rows + i * stride;
      for (std::size_t k = 0; k < 9; ++k) t[k] = read<Real>(row + sizeof(Real) * k);
    } else if (layout == Layout::columns) {
      for (int k = 0; k < 9; ++k) t[k] = read<Real>(columns[k] + i * stride);
    } else {
      for (int v = 0; v < 3; ++v) {
        const std::uint32_t place = *reinterpret_cast<const std::uint32_t*>(faces + i * stride + 4 * v);
        const bool there = place < vertex_count;
        const char* vertex = vertices + (there ? place : 0) * vertex_stride;
        for (std::size_t k = 0; k < 3; ++k)
          t[3 * v + static_cast<int>(k)] = there ? read<Real>(vertex + sizeof(Real) * k) : Real(__builtin_nanf(""));
      }
    }
  }

  // Whether the triangles are rows without gaps. size: bytes per coordinate.
  bool packed(std::size_t size) const { return layout == Layout::rows && stride == 9 * size; }
};

}  // namespace graze::cuda
