// SPDX-License-Identifier: Apache-2.0
// The lanes under test on this machine, and each lane's executor: the host, a device, its twin, or both device and
// twin.
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "backends/backends.h"
#include "core/any_pair.h"
#include "core/lanes/verdicts.h"
#include "cuda/lanes/device.h"

namespace graze::fuzz {

// What runs the CUDA lanes. automatic: the device if there is one, otherwise the twins.
enum class Executor { automatic, device, twin, both };

// A requested lane that does not run here, and the reason, such as "no fma instructions".
struct LaneLeftOut {
  std::string id, why;
};

struct SelectedLanes {
  std::vector<const Lane*> lanes;        // selected and available, in table order
  std::vector<DecideBlock> on_host;      // for each lane: the host lane or the twin; null if only the device runs it
  std::unique_ptr<cuda::Device> device;  // null if no device runs the CUDA lanes
  std::vector<std::string> asked;        // the patterns; empty: all lanes that run here, and all foreign code
  std::vector<LaneLeftOut> left_out;     // requested lanes that were left out
  bool twins_too = false;                // the device's lanes also run as twins
  bool of_doubles = false;               // some pairs are pairs of doubles

  // False for foreign code, even if it uses a device, because it runs in its own processes.
  bool on_device(std::size_t l) const { return device && backends::backend_of(*lanes[l]).has_device; }
  std::vector<const Lane*> device_lanes() const;
  // Removes the lanes for which `keep` returns false.
  void keep_if(const std::function<bool(const Lane&)>& keep);
  // Whether the lane runs on the device and, for comparison, also as its twin. The device's verdicts then count.
  bool on_both(std::size_t l) const { return on_device(l) && on_host[l]; }
  // Where the lane's verdicts come from: "device", "twin, verified on …", "twin", "device and twin, …". Empty for
  // code that this processor runs itself.
  std::string evidence(std::size_t l) const;
};

// A pattern that begins with this character leaves out the lanes that match the rest of it.
inline constexpr char kLeaveOut = '!';

// Adds the exact lane to the patterns, unless one of them selects it or leaves it out. If no pattern selects lanes, all
// lanes are selected already.
inline constexpr const char* kExactLane = "exact/f32/cpu";
// The exact lanes of doubles are selected only for pairs of doubles, or by a pattern that begins with "exact/f64/".
inline constexpr const char* kExactDoubles = "exact/f64/cpu";
inline bool is_exact_on_doubles(const Lane& lane) { return lane.exact && lane.scalar == Scalar::f64; }
std::vector<std::string> with_exact_lane(std::vector<std::string> patterns);

// not_opened: lanes of a campaign's subjects that are missing from the table because their code has changed.
// Throws: UsageError if a pattern matches no lane, or no selected lane is available; std::runtime_error if a device is
// required and there is none.
SelectedLanes select_lanes(const std::vector<std::string>& globs, Executor executor = Executor::automatic,
                           bool require_device = false, const std::vector<LaneLeftOut>& not_opened = {});

// Adds to the table the lanes with policies that the patterns name.   Throws: UsageError if a pattern matches no
// lane in the table and none in `not_opened`.
void expect_each_matches(const std::vector<std::string>& globs, const std::vector<LaneLeftOut>& not_opened = {});

// Adds the exact lanes of doubles that the patterns select.
void add_exact_on_doubles(SelectedLanes& under_test);

// Changes the selection for pairs of doubles. Adds the exact lane of doubles if the patterns select it, and removes
// double-precision lanes that take only float32 pairs.
// Returns: the lanes left out.   Throws: the errors of expect_each_runs.
std::vector<LaneLeftOut> select_for_doubles(SelectedLanes& under_test);

// Moves the lanes of foreign code to the front.
void put_own_code_first(SelectedLanes& under_test);

// Whether the lane decides pairs of this type. Single-precision lanes decide pairs of doubles rounded to float32.
bool takes(const Lane& lane, const AnyPair& pair);

// Throws: UsageError, with the reasons, if none of the lanes that match a pattern runs here. Without patterns, each
// subject needs a lane that runs here.
void expect_each_runs(const SelectedLanes& under_test);

// Removes the lanes for which `why` returns a reason.   Returns: these lanes.   Throws: the errors of expect_each_runs.
std::vector<LaneLeftOut> leave_out(SelectedLanes& under_test, const std::function<std::string(const Lane&)>& why);

// One line for each reason, with the hardware that would run the lanes: "left out (no twin; a CUDA device runs it):
// moller_1997/f32/cuda-fast".
std::vector<std::string> left_out_in_words(const std::vector<LaneLeftOut>& left_out);

// {"patterns": the requested ones, "why": {lane: reason}}, as a campaign's spec records it. Null if no lane was left
// out.
nlohmann::ordered_json left_out_json(const SelectedLanes& under_test);
// Adds the value of left_out_json to the object as "lanes_left_out", unless it is null.
void add_left_out(nlohmann::ordered_json& object, const SelectedLanes& under_test);

// The inverse of left_out_json.   Throws: nlohmann::json::exception.
std::vector<LaneLeftOut> left_out_of(const nlohmann::ordered_json& recorded);

// Whether and how the lane runs here: "available (device)", "unavailable (no fma instructions)".
std::string status(const Lane& lane, const cuda::Device* device, const std::string& why_no_device);

// Decides blocks of pairs with all lanes. Host lanes and twins decide here; a device has already decided its lanes.
class BlockVerdicts {
 public:
  explicit BlockVerdicts(const SelectedLanes& under_test);

  // on_device: the device's verdicts, by lane; `begin`: the first pair's position in them, a multiple of 64.
  // doubles: the pairs before rounding to float32, for double-precision lanes; empty for float32 pairs.
  // apart(l, i): called for each pair i on which the device and the twin of lane l differ.
  // Returns: the verdicts of each lane, valid until the next call.
  std::span<const LaneVerdicts> decide(std::span<const Pair> pairs, std::span<const VerdictBits> on_device,
                                       std::size_t begin,
                                       const std::function<void(std::size_t l, std::size_t i)>& apart,
                                       std::span<const DoublePair> doubles = {});

 private:
  const SelectedLanes& under_test_;
  std::vector<VerdictBits> on_host_;
  std::vector<LaneVerdicts> verdicts_;
};

// Each lane's verdict on one pair.
// apart: receives the lanes whose device and twin give different verdicts.
std::vector<Verdict> decide(const SelectedLanes& under_test, const AnyPair& pair, std::vector<const Lane*>& apart);

}  // namespace graze::fuzz
