// SPDX-License-Identifier: Apache-2.0
// The backends that run lanes: this processor, a process with foreign code, or a CUDA device with its twins. One table
// has a row for each backend. Other code calls the functions of a lane's row and never checks which row that is
// (scripts/check_includes.py enforces this).
#pragma once

#include <string>
#include <string_view>

#include "core/lanes/lanes.h"

namespace graze::backends {

struct Backend {
  std::string_view exact_lane;  // the exact lane of the same backend
  bool has_device;              // a device can run its lanes (cuda/lanes/device.h)
  bool is_replayed;             // on_host replays the lane: the same verdicts on every processor
  // Returns the function that computes the lane's verdicts on this host, or null if there is none.
  DecideBlock (*on_host)(const Lane& lane);
  // Why the host cannot run the lane, such as "no fma instructions"; empty if it can. why_no_device: why no device can
  // run the lane; may be empty.
  std::string (*why_not_on_host)(const Lane& lane, const std::string& why_no_device);
  // The evidence that on_host gives the lane's verdicts: "twin, verified on …". Empty if the lane's own code runs here.
  // of_doubles: whether the pairs' coordinates are doubles.
  std::string (*evidence)(const Lane& lane, bool of_doubles);
};

const Backend& backend_of(const Lane& lane);

inline DecideBlock on_host(const Lane& lane) { return backend_of(lane).on_host(lane); }
inline std::string why_not_on_host(const Lane& lane) { return backend_of(lane).why_not_on_host(lane, ""); }
inline const Lane& exact_beside(const Lane& lane) { return *find_lane(backend_of(lane).exact_lane); }

enum class Language { cpp, cuda };
Language language_of(const Lane& lane);

}  // namespace graze::backends
