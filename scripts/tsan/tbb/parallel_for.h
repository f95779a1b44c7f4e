// SPDX-License-Identifier: Apache-2.0
// See scripts/tsan/README.md.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "tbb/global_control.h"

namespace tbb {

// Calls body(i) for every i in [first, last) until a call throws; rethrows that exception.
template <class Index, class Body>
void parallel_for(Index first, Index last, const Body& body) {
  std::atomic<Index> next{first};
  std::atomic<bool> stop{false};
  std::exception_ptr failed;
  std::mutex mutex;
  const auto work = [&] {
    for (Index i = next++; i < last && !stop; i = next++) {
      try {
        body(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!stop.exchange(true)) failed = std::current_exception();
      }
    }
  };
  std::vector<std::thread> threads(std::min<std::size_t>(global_control::most(), last > first ? last - first : 0));
  for (std::thread& thread : threads) thread = std::thread(work);
  for (std::thread& thread : threads) thread.join();
  if (failed) std::rethrow_exception(failed);
}

// Each call is a task of its own already.
struct simple_partitioner {};
template <class Index, class Body>
void parallel_for(Index first, Index last, const Body& body, simple_partitioner) {
  parallel_for(first, last, body);
}

}  // namespace tbb
