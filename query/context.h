// SPDX-License-Identifier: Apache-2.0
// Checks a query, chooses an executor, and answers the query.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "cuda/query/device_query.h"
#include "query/include/graze/query_c.h"

// The type that query_c.h only declares.
struct graze_context {
 public:
  // Fills in the answer in any case; its status tells whether something is wrong.
  void run(const graze_query& query, graze_answer& answer) noexcept;

 private:
  struct Device {
    std::mutex turn;
    std::unique_ptr<graze::cuda::QueryDevice> open;  // null until it is first used, and after it failed
  };
  void answer(const graze_query& query, graze_answer& answer);
  Device& device(int number);

  std::mutex mutex_;
  std::map<int, Device> devices_;
};
