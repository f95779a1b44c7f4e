// SPDX-License-Identifier: Apache-2.0
// An engine whose device is this processor, one thread of it: the steps of cuda/engine/engine_steps.h in their order.
// It checks the engine's logic where there is no device.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "cuda/engine/engine.h"
#include "cuda/engine/engine_run.h"

namespace graze::cuda {

// on_host: what decides each lane's pairs; not asked for exact lanes.
std::unique_ptr<DeviceEngine> make_host_engine(std::span<const Lane* const> lanes, std::span<const DecideBlock> on_host,
                                               const EngineLimits& limits = {});

}  // namespace graze::cuda
