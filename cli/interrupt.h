// SPDX-License-Identifier: Apache-2.0
// Handles Ctrl-C and SIGTERM for long-running verbs: they finish the current step, report what they did, and exit with
// 130.
#pragma once

#include "core/stop.h"

namespace graze::cli {

inline constexpr int kInterrupted = 130;

// From this call on, the two signals only set the returned flag, which is stop_requested.
inline const std::atomic<bool>& catch_interrupts() {
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
  return stop_requested;
}

}  // namespace graze::cli
