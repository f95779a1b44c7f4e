// SPDX-License-Identifier: Apache-2.0
// The lanes under test on this machine, and what runs each of them: the host, a device, the device's twin, or device
// and twin.
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "backends/backends.h"
#include "core/lanes/verdicts.h"
#include "cuda/lanes/device.h"

namespace graze::fuzz {

// What runs the CUDA lanes. automatic: the device where there is one, else the twins.
enum class Executor { automatic, device, twin, both };

// A lane that was asked for and does not run here, and why: "no fma instructions".
struct LaneLeftOut {
  std::string id, why;
};

struct SelectedLanes {
  std::vector<const Lane*> lanes;        // selected and available, in table order
  std::vector<DecideBlock> on_host;      // of each: the host lane or the twin; null where only the device runs it
  std::unique_ptr<cuda::Device> device;  // null when the CUDA lanes do not run on one
  std::vector<std::string> asked;        // the patterns; none: all lanes that run here, and all of the user's own code
  std::vector<LaneLeftOut> left_out;     // of those asked for

  // Foreign code does not count, even if it uses a device: it runs in a process of its own.
  bool on_device(std::size_t l) const { return device && backends::backend_of(*lanes[l]).has_device; }
  // Those that the device runs, in order.
  std::vector<const Lane*> device_lanes() const;
  // Whether the lane runs on the device and by its twin, to be compared; the device's verdicts then count.
  bool on_both(std::size_t l) const { return on_device(l) && on_host[l]; }
  // How the lane's verdicts come about: "device", "twin, verified on …", "twin", "device and twin, …". Empty for code
  // that this processor runs itself.
  std::string evidence(std::size_t l) const;
};

// Throws: UsageError when a pattern matches no lane, or no selected lane is available; std::runtime_error when a device
// is asked for and there is none.
SelectedLanes select_lanes(const std::vector<std::string>& globs, Executor executor = Executor::automatic,
                           bool require_device = false);

// Throws: UsageError, with the reasons, when of a pattern no lane runs here; without patterns, of a user's own code.
void expect_each_runs(const SelectedLanes& under_test);

// Takes those out for which `why` has a reason.   Returns: these.   Throws: as expect_each_runs.
std::vector<LaneLeftOut> leave_out(SelectedLanes& under_test, const std::function<std::string(const Lane&)>& why);

// Those left out in words, a line for each reason: "left out (no device, and no twin): moller_1997/f32/cuda-fast".
std::vector<std::string> left_out_in_words(const std::vector<LaneLeftOut>& left_out);

// {"patterns": those asked for, "why": {lane: reason}}, as a campaign's spec records it; null where none is left out.
nlohmann::ordered_json left_out_json(const SelectedLanes& under_test);
// The same as the object's "lanes_left_out", where some are.
void add_left_out(nlohmann::ordered_json& object, const SelectedLanes& under_test);

// The inverse.   Throws: nlohmann::json::exception.
std::vector<LaneLeftOut> left_out_of(const nlohmann::ordered_json& recorded);

// What runs the lane here, or why nothing does: "available (device)", "unavailable (no fma instructions)".
std::string status(const Lane& lane, const cuda::Device* device, const std::string& why_no_device);

// Decides blocks of pairs by all lanes: by host lanes and twins here; a device has decided its lanes before.
class BlockVerdicts {
 public:
  explicit BlockVerdicts(const SelectedLanes& under_test);

  // on_device: what the device says of each of its lanes; `begin`: the first pair's place there, a multiple of 64.
  // apart(l, i): called for each pair i on which device and twin of lane l differ.
  // Returns: the verdicts of each lane, valid until the next call.
  std::span<const LaneVerdicts> decide(std::span<const Pair> pairs, std::span<const VerdictBits> on_device,
                                       std::size_t begin,
                                       const std::function<void(std::size_t l, std::size_t i)>& apart);

 private:
  const SelectedLanes& under_test_;
  std::vector<VerdictBits> on_host_;
  std::vector<LaneVerdicts> verdicts_;
};

// Each lane's verdict on one pair.
// Returns in apart, for lanes on both: those whose device and twin differ.
std::vector<Verdict> decide(const SelectedLanes& under_test, const Pair& pair, std::vector<const Lane*>& apart);

}  // namespace graze::fuzz
