// SPDX-License-Identifier: Apache-2.0
// Checks a query, chooses who works on it, and answers it.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "cuda/query/device_query.h"
#include "query/include/graze/query_c.h"

// The name that the C header gives it.
struct graze_context {
 public:
  // Returns: an answer in any case, with what is wrong as its status.
  void run(const graze_query& query, graze_answer& answer) noexcept;

 private:
  struct Device {
    std::mutex turn;
    std::unique_ptr<graze::cuda::QueryDevice> open;  // null before it is used, and after it failed
  };
  void answer(const graze_query& query, graze_answer& answer);
  Device& device(int number);

  std::mutex mutex_;
  std::map<int, Device> devices_;
};
