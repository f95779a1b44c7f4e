// SPDX-License-Identifier: Apache-2.0
// A case as a self-contained program or file with the exact bits, which a person can paste into a bug report.
#pragma once

#include <string>
#include <string_view>

#include "core/lanes/lanes.h"
#include "core/pair.h"
#include "core/verdict.h"

namespace graze::reports {

// cpp, cuda, gtest: the algorithm's own source, which shows a lane's verdict. python, cgal: programs that decide the
// pair exactly. obj: a Wavefront file. The texts are snippets/*.in.
enum class SnippetKind { cpp, cuda, python, obj, cgal, gtest };
inline constexpr std::string_view kSnippetKinds[] = {"cpp", "cuda", "python", "obj", "cgal", "gtest"};

// Whether a snippet of this kind shows the lane's verdict: cpp and gtest those of the host, cuda the device's;
// of foreign code, gtest those of CUDA lanes too.
bool shows(SnippetKind kind, const Lane& lane);

// Whether it is about a lane at all.
bool shows_lanes(SnippetKind kind);

struct SnippetCase {
  std::string name;  // where the pair came from, for a comment
  Pair pair;
  Verdict truth;
  const Lane* lane;  // of the kinds that show one
  Verdict verdict;   // what that lane says
};

// Requires: finite coordinates; truth is not declined; a lane that the kind shows, if it shows any.
std::string snippet(SnippetKind kind, const SnippetCase& found);

// The text of core/algorithms/ID.h and all it includes as one source, without includes and guards of its own; with what
// decides under a policy, if asked for.
std::string amalgamated_source(std::string_view algorithm_id, bool with_policy = false);

// A header for C++ and CUDA with one function, triangles_intersect, that decides as the lane does.
// Requires: a published algorithm, under tolerances or none.
std::string policy_header(const Lane& lane);

}  // namespace graze::reports
