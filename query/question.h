// SPDX-License-Identifier: Apache-2.0
// A query as it is meant: checked, with its arrays, its lane and its executor.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"
#include "cuda/query/triangles.h"
#include "query/include/graze/query_c.h"

namespace graze::query {

struct QueryError : std::runtime_error {
  QueryError(graze_status wrong, const std::string& what) : std::runtime_error(what), status(wrong) {}
  graze_status status;
};

struct Question {
  std::span<const float> references;
  std::vector<cuda::TriangleArray> parts;
  std::vector<std::uint64_t> counts;  // of the parts
  std::vector<int> places;            // of the parts: a device, or -1
  std::uint64_t triangles = 0;
  graze_executor executor = GRAZE_ONE_CORE;
  int threads = 1;           // where cores work
  std::vector<int> devices;  // where they do
  Lane lane;
};

// Throws: QueryError of an argument that cannot be meant, or without a device that is needed.
Question question_of(const graze_query& query);

}  // namespace graze::query
