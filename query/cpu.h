// SPDX-License-Identifier: Apache-2.0
// Queries on the cores of this machine.
#pragma once

#include "cuda/query/device_query.h"
#include "query/question.h"

namespace graze::query {

// Runs on the question's threads until no range is left. The calling thread takes the first ranges alone, because
// starting threads takes longer than finding a hit among the first triangles.
// Requires: a host lane; for doubles, the exact lane.
// Throws: std::bad_alloc, and whatever the progress callback throws.
void run_on_cpu(const Question& question, cuda::QueryWork& work);

}  // namespace graze::query
