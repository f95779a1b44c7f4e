// SPDX-License-Identifier: Apache-2.0
// Runs foreign code, which may crash or hang, in a child process. The child is killed if it reports nothing for too
// long.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "core/lanes/lanes.h"

namespace graze::analysis {

// How the work in the child reports to its parent.
class ApartFrom {
 public:
  explicit ApartFrom(int pipe) : pipe_(pipe) {}
  void alive() const;                                       // restarts the time limit for the next step
  void finish(const void* result, std::size_t size) const;  // call it once, at the end

 private:
  int pipe_;
};

enum class Ended { in_order, crashed, silent };

// Runs the work. Each step may take at most `seconds`.   result: the data that the work passed to `finish`, if it ended
// normally.
// Throws: std::runtime_error if no process can be started; the message names the lane.
Ended run_apart(const Lane& lane, double seconds, const std::function<void(const ApartFrom&)>& work,
                std::string& result);

}  // namespace graze::analysis
