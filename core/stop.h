// SPDX-License-Identifier: Apache-2.0
// The request to stop, by Ctrl-C or SIGTERM. Code that may wait long checks for a request at least ten times a second.
#pragma once

#include <atomic>
#include <csignal>

namespace graze {

inline std::atomic<bool> stop_requested{false};

// Thrown by code that cannot finish soon after a request to stop. The verb then ends as if the request had come between
// two steps. Not a std::exception, so handlers of expected failures do not catch it.
struct Stopped {};

extern "C" inline void request_stop(int) { stop_requested = true; }

// While an object of this class exists, Ctrl-C and SIGTERM only set the flag and do not end the process. For verbs that
// wait and do not handle the signals themselves. An ignored signal remains ignored.
class StopSignals {
 public:
  StopSignals() {
    for (int i = 0; i < 2; ++i) {
      struct sigaction now {};
      sigaction(kSignals[i], nullptr, &now);
      ends_[i] = now.sa_handler == SIG_DFL;
      if (ends_[i]) std::signal(kSignals[i], request_stop);
    }
  }
  ~StopSignals() {
    for (int i = 0; i < 2; ++i) {
      if (ends_[i]) std::signal(kSignals[i], SIG_DFL);
    }
  }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

 private:
  static constexpr int kSignals[] = {SIGINT, SIGTERM};
  bool ends_[2];
};

}  // namespace graze
