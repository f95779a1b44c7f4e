// SPDX-License-Identifier: Apache-2.0
// Adds up the results of tasks that run on several threads.
#pragma once

#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <cstddef>
#include <type_traits>

namespace graze::analysis {

// As long as the returned object lives, oneTBB uses at most this many threads (0: one for each core).
inline tbb::global_control thread_limit(int threads) {
  return tbb::global_control(tbb::global_control::max_allowed_parallelism,
                             static_cast<std::size_t>(threads > 0 ? threads : tbb::info::default_concurrency()));
}

// Calls work(task, result) for each task below `tasks`, on this many threads (as in thread_limit). Each thread has its
// own result, which starts as empty(). Returns: the sum of the results, made with add(sum, result). The sum must not
// depend on the order of the results.
template <class Empty, class Work, class Add>
auto sum_over_threads(std::size_t tasks, int threads, const Empty& empty, const Work& work, const Add& add) {
  const tbb::global_control limit = thread_limit(threads);
  tbb::enumerable_thread_specific<std::invoke_result_t<const Empty&>> results(empty);
  tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t task) { work(task, results.local()); });
  auto sum = empty();
  for (const auto& result : results) add(sum, result);
  return sum;
}

}  // namespace graze::analysis
