// SPDX-License-Identifier: Apache-2.0
// An engine that runs the steps of cuda/engine/engine_steps.h in the same order on one CPU thread. Tests use it to
// check the engine's logic without a device.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "cuda/engine/engine.h"
#include "cuda/engine/engine_run.h"

namespace graze::cuda {

// on_host[i] decides pairs with lanes[i]; it is not called for exact lanes. On a source of doubles, lanes in double
// decide the doubles, and lanes in float decide the pairs rounded to float32.
std::unique_ptr<DeviceEngine> make_host_engine(std::span<const Lane* const> lanes, std::span<const DecideBlock> on_host,
                                               const EngineLimits& limits = {});

}  // namespace graze::cuda
