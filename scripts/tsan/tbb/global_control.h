// SPDX-License-Identifier: Apache-2.0
// See scripts/tsan/README.md.
#pragma once

#include <atomic>
#include <cstddef>

namespace tbb {

class global_control {
 public:
  enum parameter { max_allowed_parallelism };

  global_control(parameter, std::size_t threads) : before_(most().exchange(threads)) {}
  ~global_control() { most() = before_; }
  global_control(const global_control&) = delete;
  global_control& operator=(const global_control&) = delete;

  static std::atomic<std::size_t>& most() {
    static std::atomic<std::size_t> threads{4};
    return threads;
  }

 private:
  std::size_t before_;
};

}  // namespace tbb
