// SPDX-License-Identifier: Apache-2.0
// The verbs of `graze`: each adds its subcommand, whose callback runs it and leaves the exit status.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "core/lanes.h"
#include "cuda/device.h"

namespace graze {

void add_fuzz(CLI::App& app, int& status);
void add_check(CLI::App& app, int& status);
void add_repro(CLI::App& app, int& status);
void add_lanes(CLI::App& app, int& status);
void add_strata(CLI::App& app, int& status);

// The lanes that this machine can run, and what it runs them on.
struct Bench {
  std::vector<const Lane*> lanes;  // selected and available, in table order
  std::unique_ptr<Device> device;  // null when there is none
};

// Throws: UsageError when a pattern matches no lane, or no selected lane is available; std::runtime_error when
// `require_device` and there is none.
Bench make_bench(const std::vector<std::string>& globs, bool require_device = false);

// Why the lane cannot run here: "no device", "built without CUDA", "no FMA instructions"; empty when it can.
std::string unavailable(const Lane& lane, const Device* device, const std::string& why_no_device);

// Each lane's verdict on one pair.
std::vector<Verdict> decide(const Bench& bench, const Pair& pair);

}  // namespace graze
