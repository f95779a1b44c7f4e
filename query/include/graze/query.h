// SPDX-License-Identifier: Apache-2.0
// Tests reference triangles against an array of triangles, for C++20. Adds owners, spans and vectors to
// <graze/query_c.h>, which describes the fields.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <new>
#include <span>
#include <string_view>
#include <vector>

#include <graze/query_c.h>

namespace graze::query {

using Triangle = std::array<float, 9>;  // x y z of each vertex

// An array of a type whose first nine floats are a triangle's coordinates.
template <class T>
graze_triangles rows_of(std::span<const T> triangles) {
  static_assert(sizeof(T) >= sizeof(Triangle) && alignof(T) % alignof(float) == 0);
  graze_triangles part = {};
  part.device = -1;
  part.count = triangles.size();
  part.rows = reinterpret_cast<const float*>(triangles.data());
  part.stride = sizeof(T);
  return part;
}

// Triangles whose nine coordinates lie in nine arrays.
inline graze_triangles columns_of(const std::array<const float*, 9>& columns, std::uint64_t count) {
  graze_triangles part = {};
  part.layout = GRAZE_COLUMNS;
  part.device = -1;
  part.count = count;
  for (int k = 0; k < 9; ++k) part.columns[k] = columns[static_cast<std::size_t>(k)];
  return part;
}

// The faces of a mesh, each with the indices of three vertices.
inline graze_triangles mesh_of(std::span<const std::array<float, 3>> vertices,
                               std::span<const std::array<std::uint32_t, 3>> faces) {
  graze_triangles part = {};
  part.layout = GRAZE_MESH;
  part.device = -1;
  part.count = faces.size();
  part.vertices = vertices.empty() ? nullptr : vertices.data()->data();
  part.vertex_count = vertices.size();
  part.faces = faces.empty() ? nullptr : faces.data()->data();
  return part;
}

// The answer of a call. `if (answer)` tests whether the call succeeded.
struct Answer : graze_answer {
  explicit operator bool() const { return status == GRAZE_OK; }
  std::string_view what() const { return message; }
};

// A query for all triangles of a part, which may then be changed.   Requires: reference and part outlive the query.
inline graze_query query_of(const Triangle& reference, const graze_triangles& part) {
  graze_query query = {};
  query.size = sizeof query;
  query.references = reference.data();
  query.reference_count = 1;
  query.parts = &part;
  query.part_count = 1;
  query.mode = GRAZE_ALL;
  return query;
}

class Context {
 public:
  // Throws: std::bad_alloc.
  Context() : context_(graze_open(), graze_close) {
    if (!context_) throw std::bad_alloc();
  }

  Answer run(const graze_query& query) const noexcept {
    Answer answer;
    graze_run(context_.get(), &query, &answer);
    return answer;
  }

  // Whether any triangle meets the reference: hits is 0 or 1; first is the first triangle that meets it.
  Answer any(const Triangle& reference, const graze_triangles& part) const noexcept {
    graze_query query = query_of(reference, part);
    query.mode = GRAZE_ANY;
    return run(query);
  }

  // How many triangles meet the reference.
  Answer count(const Triangle& reference, const graze_triangles& part) const noexcept {
    return run(query_of(reference, part));
  }

  // For each triangle: 1 if it meets the reference, 0 if not, 2 if declined.   Throws: std::bad_alloc for the vector.
  Answer all(const Triangle& reference, const graze_triangles& part, std::vector<std::uint8_t>& bytes) const {
    graze_query query = query_of(reference, part);
    if (part.count > GRAZE_MOST_TRIANGLES) return run(query);  // which rejects it
    bytes.resize(part.count);
    query.bytes = bytes.data();
    return run(query);
  }

 private:
  std::unique_ptr<graze_context, void (*)(graze_context*)> context_;
};

}  // namespace graze::query
