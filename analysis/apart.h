// SPDX-License-Identifier: Apache-2.0
// Runs work on foreign code in a child process, which is killed if it writes nothing for too long. The code may crash
// or hang.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "core/lanes/lanes.h"

namespace graze::analysis {

// The functions that the work in the child may call.
class ApartFrom {
 public:
  explicit ApartFrom(int pipe) : pipe_(pipe) {}
  void alive() const;                                       // restarts the time limit for the next step
  void finish(const void* result, std::size_t size) const;  // call it once, at the end

 private:
  int pipe_;
};

enum class Ended { in_order, crashed, silent };

// Runs the work. Each step may take `seconds`.   result: receives what the work passed to `finish`, if it ended in
// order.
// Throws: std::runtime_error if no process can be started; the message names the lane.
Ended run_apart(const Lane& lane, double seconds, const std::function<void(const ApartFrom&)>& work,
                std::string& result);

}  // namespace graze::analysis
