// SPDX-License-Identifier: Apache-2.0
// The inputs of `graze query`: reference triangles, and the triangles of a mesh.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "core/any_pair.h"
#include "strata/mesh.h"

namespace graze::cli {

// The lanes of a query. `exact` is the exact lane on any executor; the table of lanes does not list it.
struct QueryLanes {
  std::vector<std::string> ids;  // lanes that run on cores, or on GPUs if there are any
  fuzz::SelectedLanes under_test;
};

// Opens the subjects. Without patterns, selects `common` and the subjects' lanes. Reports which requested lanes do not
// run. Throws: UsageError if a pattern or a subject selects no lane, or none that runs here.
QueryLanes query_lanes(const LaneOptions& options, const std::vector<std::string>& common);

// Reads a text file with nine numbers for each reference, or one triangle of a mesh, named MESH#FACE; faces count from
// 0. Throws: std::runtime_error that names the file and the line; UsageError if FACE is not a whole number.
strata::MeshPairs read_references(const std::string& name);

// Like say_notes in cli/cases.h, but for both inputs.
void say_notes(const strata::MeshPairs& references, const strata::MeshPairs& mesh, bool exact_input, bool are_doubles);

template <class Real>
using TriangleOf = std::array<Vec3<Real>, 3>;

template <class Real>
BasicPair<Real> pair_of(const TriangleOf<Real>& a, const TriangleOf<Real>& b) {
  return {{a[0], a[1], a[2]}, {b[0], b[1], b[2]}};
}

inline TriangleOf<double> first_of(const AnyPair& pair) {
  return {pair.doubles.a[0], pair.doubles.a[1], pair.doubles.a[2]};
}
inline TriangleOf<double> second_of(const AnyPair& pair) {
  return {pair.doubles.b[0], pair.doubles.b[1], pair.doubles.b[2]};
}

// The triangles as an OBJ file, in named groups. Each number is written with enough digits to be read back exactly, as
// a float32 if float32 can hold it, otherwise as a double.
struct ObjGroup {
  std::string name;
  std::vector<TriangleOf<double>> triangles;
};
std::string obj_of(const std::vector<ObjGroup>& groups);

}  // namespace graze::cli
