// SPDX-License-Identifier: Apache-2.0
// A case as a self-contained program or file with its exact bits, to paste into a bug report.
#pragma once

#include <string>
#include <string_view>

#include "core/any_pair.h"
#include "core/lanes/lanes.h"
#include "core/verdict.h"

namespace graze::reports {

// cpp, cuda and gtest include the algorithm's own source and show a lane's verdict. python and cgal are programs that
// decide the pair exactly. obj is a Wavefront file. The templates are snippets/*.in.
enum class SnippetKind { cpp, cuda, python, obj, cgal, gtest };
inline constexpr std::string_view kSnippetKinds[] = {"cpp", "cuda", "python", "obj", "cgal", "gtest"};

// Whether a snippet of this kind can show the lane's verdict: cpp and gtest show host lanes, cuda shows device lanes.
// gtest also shows CUDA lanes of foreign code.
bool shows(SnippetKind kind, const Lane& lane);

// Whether snippets of this kind show a lane.
bool shows_lanes(SnippetKind kind);

struct SnippetCase {
  std::string name;  // the pair's origin, for a comment
  AnyPair pair;
  Verdict truth;
  const Lane* lane;  // set if the kind shows a lane
  Verdict verdict;   // the verdict of `lane`
};

// Requires: finite coordinates; truth is not declined; a lane that the kind shows, if it shows lanes.
std::string snippet(SnippetKind kind, const SnippetCase& found);

// The text of a source file that the build embeds (CMakeLists.txt).   Throws: std::logic_error if it is not embedded.
std::string_view embedded(std::string_view path);

// Returns core/algorithms/ID.h and everything that it includes as one source, without the project's own includes and
// include guards. If `with_policy` is set, adds the code that decides under a policy.
std::string amalgamated_source(std::string_view algorithm_id, bool with_policy = false);

// The text of the source line at a place such as "core/vec3.h:52", without its indentation. Empty if that line is in no
// algorithm's source.
std::string source_line(const std::string& place);

// Returns a header for C++ and CUDA with one function, triangles_intersect, that decides like the lane.
// Requires: a lane of a published algorithm, with tolerances or without a policy.
std::string policy_header(const Lane& lane);

}  // namespace graze::reports
