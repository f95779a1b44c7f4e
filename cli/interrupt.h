// SPDX-License-Identifier: Apache-2.0
// Ctrl-C and SIGTERM for verbs that run long: they end what they are at, say what they did, and exit with 130.
#pragma once

#include "core/stop.h"

namespace graze::cli {

inline constexpr int kInterrupted = 130;

// From here on the two signals only set this flag, which is stop_requested.
const std::atomic<bool>& catch_interrupts();

}  // namespace graze::cli
