// SPDX-License-Identifier: Apache-2.0
// The request to stop, of Ctrl-C or SIGTERM. Whatever may wait long looks at it at least ten times a second.
#pragma once

#include <atomic>
#include <csignal>

namespace graze {

inline std::atomic<bool> stop_requested{false};

// Thrown out of what cannot come to its end in time; a verb then ends as if it had been asked between two steps. It is
// no std::exception: nobody who expects something to fail takes it for that failure.
struct Stopped {};

extern "C" inline void request_stop(int) { stop_requested = true; }

// While it lives, Ctrl-C and SIGTERM only set the flag, where they would end the process: for a wait within a verb that
// does not catch them. A signal that is ignored stays ignored.
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
