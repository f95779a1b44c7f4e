// SPDX-License-Identifier: Apache-2.0
// A query after validation, with its arrays, its lane and its executor, and how the cores of this machine run it.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"
#include "cuda/query/device_query.h"
#include "query/include/graze/query_c.h"

namespace graze::query {

struct QueryError : std::runtime_error {
  QueryError(graze_status wrong, const std::string& what) : std::runtime_error(what), status(wrong) {}
  graze_status status;
};

// What a device needs to know, plus what the cores and the collector need.
struct Question : cuda::DeviceQuestion {
  std::vector<std::uint64_t> counts;  // the number of triangles in each part
  graze_executor executor = GRAZE_ONE_CORE;
  int threads = 1;           // used if cores do the work
  std::vector<int> devices;  // used if devices do the work
};

// Returns the function that runs a lane on cores. By default this is the lane's own function, or null for a CUDA lane,
// because the library contains no twins. A program that has twins replaces this hook before its first query.
extern DecideBlock (*on_cores)(const Lane& lane);

// Throws: QueryError if an argument is invalid or a required device is missing.
Question question_of(const graze_query& query);

// Runs on the question's threads until no range is left. The calling thread takes the first ranges alone, because
// starting threads takes longer than finding a hit among the first triangles.
// Requires: a host lane; for doubles, the exact lane.
// Throws: std::bad_alloc, and whatever the progress callback throws.
void run_on_cpu(const Question& question, cuda::QueryWork& work);

}  // namespace graze::query
