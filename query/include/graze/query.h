// SPDX-License-Identifier: Apache-2.0
// Tests reference triangles against an array of triangles, for C++20. Adds owning types, spans and vectors to
// <graze/query_c.h>, which describes the fields.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <new>
#include <ranges>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include <graze/query_c.h>

namespace graze::query {

using Triangle = std::array<float, 9>;  // x y z of each vertex
using DoubleTriangle = std::array<double, 9>;

// Describes an array whose elements begin with a triangle's nine coordinates, of the query's type.
template <class T>
graze_triangles rows_of(std::span<const T> triangles) {
  static_assert(sizeof(T) >= sizeof(Triangle) && alignof(T) % alignof(float) == 0);
  graze_triangles part = {};
  part.device = -1;
  part.count = triangles.size();
  part.rows = triangles.data();
  part.stride = sizeof(T);
  return part;
}

// Triangles whose nine coordinates lie in nine arrays.
template <class Real>
graze_triangles columns_of(const std::array<const Real*, 9>& columns, std::uint64_t count) {
  graze_triangles part = {};
  part.layout = GRAZE_COLUMNS;
  part.device = -1;
  part.count = count;
  for (int k = 0; k < 9; ++k) part.columns[k] = columns[static_cast<std::size_t>(k)];
  return part;
}

// The faces of a mesh, each with the indices of three vertices. Vertices are std::array<float, 3> or <double, 3>.
template <std::ranges::contiguous_range Vertices>
graze_triangles mesh_of(const Vertices& vertices, std::span<const std::array<std::uint32_t, 3>> faces) {
  using Vertex = std::ranges::range_value_t<Vertices>;
  static_assert(std::is_same_v<Vertex, std::array<float, 3>> || std::is_same_v<Vertex, std::array<double, 3>>);
  graze_triangles part = {};
  part.layout = GRAZE_MESH;
  part.device = -1;
  part.count = faces.size();
  part.vertices = std::ranges::data(vertices);
  part.vertex_count = std::ranges::size(vertices);
  part.faces = faces.empty() ? nullptr : faces.data()->data();
  return part;
}

// The answer to a call. `if (answer)` tests whether the call succeeded.
struct Answer : graze_answer {
  explicit operator bool() const { return status == GRAZE_OK; }
  std::string_view what() const { return message; }
};

// Returns a query for all triangles of a part; the caller may change its fields. The part's coordinates have the
// reference's type.
// Requires: reference and part outlive the query.
template <class Real>
graze_query query_of(const std::array<Real, 9>& reference, const graze_triangles& part) {
  static_assert(std::is_same_v<Real, float> || std::is_same_v<Real, double>);
  graze_query query = {};
  query.coordinates = std::is_same_v<Real, double> ? GRAZE_F64 : GRAZE_F32;
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
  template <class Real>
  Answer any(const std::array<Real, 9>& reference, const graze_triangles& part) const noexcept {
    graze_query query = query_of(reference, part);
    query.mode = GRAZE_ANY;
    return run(query);
  }

  // How many triangles meet the reference.
  template <class Real>
  Answer count(const std::array<Real, 9>& reference, const graze_triangles& part) const noexcept {
    return run(query_of(reference, part));
  }

  // For each triangle: 1 if it meets the reference, 0 if not, 2 if declined.   Throws: std::bad_alloc for the vector.
  template <class Real>
  Answer all(const std::array<Real, 9>& reference, const graze_triangles& part,
             std::vector<std::uint8_t>& bytes) const {
    graze_query query = query_of(reference, part);
    if (part.count > GRAZE_MOST_TRIANGLES) return run(query);  // the query rejects the count
    bytes.resize(part.count);
    query.bytes = bytes.data();
    return run(query);
  }

 private:
  std::unique_ptr<graze_context, void (*)(graze_context*)> context_;
};

}  // namespace graze::query
