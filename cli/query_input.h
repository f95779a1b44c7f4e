// SPDX-License-Identifier: Apache-2.0
// The inputs of `graze query`: reference triangles, and the triangles of a mesh.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <graze/query.h>

#include "cli/commands.h"
#include "core/pair.h"
#include "strata/mesh.h"

namespace graze::cli {

// The lanes of a query. `exact` is the exact lane on any executor; the table of lanes does not list it.
struct QueryLanes {
  std::vector<std::string> ids;  // of lanes that run on cores, or on GPUs if there are any
  fuzz::SelectedLanes under_test;
};

// Opens the subjects. Without patterns selects `common` and the subjects. Reports which requested lanes do not run.
// Throws: UsageError if no lane of a pattern or subject exists, or runs here.
QueryLanes query_lanes(const LaneOptions& options, const std::vector<std::string>& common);

struct Input {
  std::vector<query::Triangle> triangles;
  std::vector<query::DoubleTriangle> in_doubles;     // the same, if float32 rounded a coordinate; else may be empty
  std::vector<std::string> notes, notes_of_doubles;  // see strata::MeshPairs
  strata::Rounding rounding;
};

// The triangles as doubles, which hold every float32 exactly.
std::vector<query::DoubleTriangle> in_doubles(const Input& input);

// Reads a text file with nine numbers for each reference, or MESH#FACE, one triangle of a mesh; faces count from 0.
// Throws: std::runtime_error that names the file and the line; UsageError if FACE is not a whole number.
Input read_references(const std::string& name);

Input read_mesh(const std::string& file, strata::Coordinates coordinates = strata::Coordinates::finite);

// Like say_notes in cli/cases.h, but for both inputs.
void say_notes(const Input& references, const Input& mesh, bool exact_input, bool are_doubles = false);

template <class Real>
BasicPair<Real> pair_of(const std::array<Real, 9>& a, const std::array<Real, 9>& b) {
  BasicPair<Real> pair;
  std::copy(a.begin(), a.end(), coordinates(pair));
  std::copy(b.begin(), b.end(), coordinates(pair) + 9);
  return pair;
}

template <class Real>
query::DoubleTriangle in_doubles(const std::array<Real, 9>& triangle) {
  query::DoubleTriangle result;
  std::copy(triangle.begin(), triangle.end(), result.begin());
  return result;
}

// The triangles as an OBJ file, in named groups. Each number has enough digits to distinguish it from all others of its
// type: float32 if float32 can hold it, otherwise double.
struct ObjGroup {
  std::string name;
  std::vector<std::array<double, 9>> triangles;
};
std::string obj_of(const std::vector<ObjGroup>& groups);

}  // namespace graze::cli
