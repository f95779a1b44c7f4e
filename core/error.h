// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace graze {

// The user asked for something that cannot be meant: the command exits with 2, where other errors exit with 1.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace graze
