// SPDX-License-Identifier: Apache-2.0
// A query after validation, with its arrays, its lane and its executor.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"
#include "cuda/lanes/triangles.h"
#include "query/include/graze/query_c.h"

namespace graze::query {

struct QueryError : std::runtime_error {
  QueryError(graze_status wrong, const std::string& what) : std::runtime_error(what), status(wrong) {}
  graze_status status;
};

struct Question {
  bool in_doubles = false;           // the coordinates of references and triangles; otherwise in floats
  const void* references = nullptr;  // nine coordinates each
  std::uint64_t reference_count = 0;
  std::vector<cuda::TriangleArray> parts;
  std::vector<std::uint64_t> counts;  // of triangles in each part
  std::vector<int> places;            // of each part: a device, or -1
  std::uint64_t triangles = 0;
  bool any = false;  // stops at the first hit
  graze_executor executor = GRAZE_ONE_CORE;
  int threads = 1;           // if cores do the work
  std::vector<int> devices;  // if devices do the work
  Lane lane;
};

// The function that runs a lane on cores: the lane's own code, or none for CUDA lanes, because the library has no
// twins. A program with twins sets another function before its first query.
extern DecideBlock (*on_cores)(const Lane& lane);

// Throws: QueryError if an argument is invalid or a required device is missing.
Question question_of(const graze_query& query);

}  // namespace graze::query
