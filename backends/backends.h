// SPDX-License-Identifier: Apache-2.0
// The backends that run lanes: this processor, a process with foreign code, or a CUDA device and its twins. Each is a
// row of one table. Other code uses the functions of a lane's row and never tests which row it is
// (scripts/check_includes.py checks that).
#pragma once

#include <string>
#include <string_view>

#include "core/lanes/lanes.h"

namespace graze::backends {

struct Backend {
  std::string_view exact_lane;  // the exact lane that runs in the same place
  bool has_device;              // a device can run its lanes (cuda/lanes/device.h)
  bool is_replayed;             // on_host replays the lane: the same verdicts on every processor
  // The function that gives the lane's verdicts on this host; null if there is none.
  DecideBlock (*on_host)(const Lane& lane);
  // Why the host cannot run the lane: "no fma instructions". Empty if it can. why_no_device: why no device runs the
  // lane; may be empty.
  std::string (*why_not_on_host)(const Lane& lane, const std::string& why_no_device);
  // The evidence that on_host gives the lane's verdicts: "twin, verified on …". Empty if the lane's own code runs here.
  // of_doubles: whether the pairs are pairs of doubles.
  std::string (*evidence)(const Lane& lane, bool of_doubles);
};

const Backend& backend_of(const Lane& lane);

inline DecideBlock on_host(const Lane& lane) { return backend_of(lane).on_host(lane); }
inline std::string why_not_on_host(const Lane& lane) { return backend_of(lane).why_not_on_host(lane, ""); }
inline const Lane& exact_beside(const Lane& lane) { return *find_lane(backend_of(lane).exact_lane); }

// The language of the lane's source.
enum class Language { cpp, cuda };
Language language_of(const Lane& lane);

}  // namespace graze::backends
