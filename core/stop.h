// SPDX-License-Identifier: Apache-2.0
// The request to stop, of Ctrl-C or SIGTERM. Whatever may wait long looks at it at least ten times a second.
#pragma once

#include <atomic>

namespace graze {

inline std::atomic<bool> stop_requested{false};

// Thrown out of what cannot come to its end in time; a verb then ends as if it had been asked between two steps. It is
// no std::exception: nobody who expects something to fail takes it for that failure.
struct Stopped {};

}  // namespace graze
