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
#include "core/any_pair.h"
#include "core/lanes/verdicts.h"
#include "cuda/lanes/device.h"

namespace graze::fuzz {

// What runs the CUDA lanes. automatic: the device if there is one, else the twins.
enum class Executor { automatic, device, twin, both };

// A requested lane that does not run here, and the reason, such as "no fma instructions".
struct LaneLeftOut {
  std::string id, why;
};

struct SelectedLanes {
  std::vector<const Lane*> lanes;        // selected and available, in table order
  std::vector<DecideBlock> on_host;      // of each: the host lane or the twin; null where only the device runs it
  std::unique_ptr<cuda::Device> device;  // null when the CUDA lanes do not run on one
  std::vector<std::string> asked;        // the patterns; none: all lanes that run here, and all of the user's own code
  std::vector<LaneLeftOut> left_out;     // of those asked for
  bool twins_too = false;                // what the device runs runs as twins as well
  bool of_doubles = false;               // some of the pairs are of doubles

  // False for foreign code, even if it uses a device, because it runs in a process of its own.
  bool on_device(std::size_t l) const { return device && backends::backend_of(*lanes[l]).has_device; }
  // The lanes that run on the device, in order.
  std::vector<const Lane*> device_lanes() const;
  // Whether the lane runs on the device and as its twin, for comparison. The device's verdicts count.
  bool on_both(std::size_t l) const { return on_device(l) && on_host[l]; }
  // Where the lane's verdicts come from: "device", "twin, verified on …", "twin", "device and twin, …". Empty for
  // code that this processor runs itself.
  std::string evidence(std::size_t l) const;
};

// A pattern that begins with this leaves the lanes out that match the rest of it.
inline constexpr char kLeaveOut = '!';

// Adds the exact lane to the patterns, unless one of them selects it or leaves it out. If none selects lanes, all are
// selected already.
inline constexpr const char* kExactLane = "exact/f32/cpu";
// The exact lanes of doubles run only on pairs of doubles, or where a pattern begins with "exact/f64/".
inline constexpr const char* kExactDoubles = "exact/f64/cpu";
inline bool is_exact_on_doubles(const Lane& lane) { return lane.exact && lane.scalar == Scalar::f64; }
std::vector<std::string> with_exact_lane(std::vector<std::string> patterns);

// not_opened: lanes of a campaign's subjects that are not in the table, because their code has changed.
// Throws: UsageError when a pattern matches no lane, or no selected lane is available; std::runtime_error when a device
// is asked for and there is none.
SelectedLanes select_lanes(const std::vector<std::string>& globs, Executor executor = Executor::automatic,
                           bool require_device = false, const std::vector<LaneLeftOut>& not_opened = {});

// Adds the lanes under policies that the patterns name.   Throws: UsageError when a pattern matches no lane of the
// table, and none of `not_opened`.
void expect_each_matches(const std::vector<std::string>& globs, const std::vector<LaneLeftOut>& not_opened = {});

// Adds the exact lanes of pairs of doubles that the patterns select.
void add_exact_on_doubles(SelectedLanes& under_test);

// Makes the lanes those of pairs of doubles: adds the exact lane for them if the patterns select it, and leaves out the
// lanes in double that take float32 pairs alone.   Returns: these.   Throws: as expect_each_runs.
std::vector<LaneLeftOut> select_for_doubles(SelectedLanes& under_test);

// Moves lanes of foreign code before the others.
void put_own_code_first(SelectedLanes& under_test);

// Whether the lane decides pairs of this type. Lanes in float decide doubles as float32 stores them.
bool takes(const Lane& lane, const AnyPair& pair);

// Throws: UsageError, with the reasons, if no lane of a pattern runs here, or, without patterns, none of a subject.
void expect_each_runs(const SelectedLanes& under_test);

// Removes the lanes for which `why` returns a reason.   Returns: these.   Throws: as expect_each_runs.
std::vector<LaneLeftOut> leave_out(SelectedLanes& under_test, const std::function<std::string(const Lane&)>& why);

// A line for each reason, with what would run the lanes: "left out (no twin; a CUDA device runs it):
// moller_1997/f32/cuda-fast".
std::vector<std::string> left_out_in_words(const std::vector<LaneLeftOut>& left_out);

// {"patterns": the requested ones, "why": {lane: reason}}, as a campaign's spec records it. Null for none.
nlohmann::ordered_json left_out_json(const SelectedLanes& under_test);
// Adds the same to the object as "lanes_left_out", if there is any.
void add_left_out(nlohmann::ordered_json& object, const SelectedLanes& under_test);

// The inverse.   Throws: nlohmann::json::exception.
std::vector<LaneLeftOut> left_out_of(const nlohmann::ordered_json& recorded);

// Whether and how the lane runs here: "available (device)", "unavailable (no fma instructions)".
std::string status(const Lane& lane, const cuda::Device* device, const std::string& why_no_device);

// Decides blocks of pairs by all lanes: by host lanes and twins here; a device has decided its lanes before.
class BlockVerdicts {
 public:
  explicit BlockVerdicts(const SelectedLanes& under_test);

  // on_device: the device's verdicts, by lane; `begin`: the first pair's place there, a multiple of 64.
  // doubles: empty; or the pairs before they were stored in float32, which lanes in double decide.
  // apart(l, i): called for each pair i on which device and twin of lane l differ.
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
// apart: receives the lanes that run on both and whose device and twin differ.
std::vector<Verdict> decide(const SelectedLanes& under_test, const AnyPair& pair, std::vector<const Lane*>& apart);

}  // namespace graze::fuzz
