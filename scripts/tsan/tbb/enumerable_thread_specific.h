// SPDX-License-Identifier: Apache-2.0
// See scripts/tsan/README.md.
#pragma once

#include <functional>
#include <list>
#include <map>
#include <mutex>
#include <thread>

namespace tbb {

// A separate value for each thread.
template <class T>
class enumerable_thread_specific {
 public:
  enumerable_thread_specific() : make_([] { return T(); }) {}
  explicit enumerable_thread_specific(const T& value) : make_([value] { return value; }) {}
  template <class Make>
  requires std::is_invocable_r_v<T, Make>
  explicit enumerable_thread_specific(Make make) : make_(make) {}

  T& local() {
    const std::lock_guard lock(mutex_);
    T*& own = of_thread_[std::this_thread::get_id()];
    if (!own) own = &values_.emplace_back(make_());
    return *own;
  }
  auto begin() { return values_.begin(); }
  auto end() { return values_.end(); }

 private:
  std::function<T()> make_;
  std::mutex mutex_;
  std::map<std::thread::id, T*> of_thread_;
  std::list<T> values_;
};

}  // namespace tbb
