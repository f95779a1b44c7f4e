// SPDX-License-Identifier: Apache-2.0
// The inputs of `graze query`: reference triangles, and the triangles of a mesh.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <graze/query.h>

#include "cli/commands.h"
#include "core/pair.h"
#include "strata/mesh.h"

namespace graze::cli {

// The lanes of a query. `exact` is the exact lane on any executor; it is in no table.
struct QueryLanes {
  std::vector<std::string> ids;  // of lanes that run on cores, or on GPUs if there are any
  fuzz::SelectedLanes under_test;
};

// Opens the subjects. Without patterns selects `common` and the subjects. Says which requested lanes do not run.
// Throws: UsageError if no lane of a pattern or subject exists, or runs here.
QueryLanes query_lanes(const LaneOptions& options, const std::vector<std::string>& common);

struct Input {
  std::vector<query::Triangle> triangles;
  std::vector<std::string> notes;  // see strata::MeshPairs
  strata::Rounding rounding;
};

// Reads a text file with nine numbers for each reference, or MESH#FACE, one triangle of a mesh; faces count from 0.
// Throws: std::runtime_error that names the file and the line; UsageError if FACE is not a whole number.
Input read_references(const std::string& name);

Input read_mesh(const std::string& file, strata::Coordinates coordinates = strata::Coordinates::finite);

// As in cli/cases.h, of both.
void say_notes(const Input& references, const Input& mesh, bool exact_input);

Pair pair_of(const query::Triangle& a, const query::Triangle& b);

std::array<double, 9> in_doubles(const query::Triangle& triangle);

// The triangles as an OBJ file, in named groups. Each number has the digits that tell it from others of its type:
// float32 if that holds it, else double.
struct ObjGroup {
  std::string name;
  std::vector<std::array<double, 9>> triangles;
};
std::string obj_of(const std::vector<ObjGroup>& groups);

}  // namespace graze::cli
