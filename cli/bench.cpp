// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "cli/commands.h"
#include "core/error.h"

namespace graze {

std::string unavailable(const Lane& lane, const Device* device, const std::string& why_no_device) {
  if (lane.is_cuda()) return device ? "" : why_no_device;
  return runs_on_this_cpu(lane) ? "" : "no FMA instructions";
}

Bench make_bench(const std::vector<std::string>& globs, bool require_device) {
  for (const std::string& glob : globs) {
    if (std::none_of(lanes().begin(), lanes().end(), [&](const Lane& lane) { return matches_any({glob}, lane.id); })) {
      throw UsageError("expected a lane (see `graze lanes`), found '" + glob + "'");
    }
  }
  Bench bench;
  std::string why_no_device, why_not;
  bench.device = open_device(why_no_device);
  if (require_device && !bench.device) throw std::runtime_error("expected a CUDA device, found: " + why_no_device);
  for (const Lane& lane : lanes()) {
    if (!matches_any(globs, lane.id)) continue;
    const std::string reason = unavailable(lane, bench.device.get(), why_no_device);
    if (reason.empty()) {
      bench.lanes.push_back(&lane);
    } else {
      why_not = reason;
    }
  }
  if (bench.lanes.empty())
    throw UsageError("expected a lane that runs here, found only unavailable ones (" + why_not + ")");
  return bench;
}

std::vector<Verdict> decide(const Bench& bench, const Pair& pair) {
  std::vector<Verdict> verdicts(bench.lanes.size());
  std::vector<const Lane*> cuda_lanes;
  const auto verdict = [](std::uint64_t intersects, std::uint64_t declined) {
    return declined & 1 ? Verdict::declined : intersects & 1 ? Verdict::intersects : Verdict::disjoint;
  };
  for (std::size_t l = 0; l < bench.lanes.size(); ++l) {
    if (bench.lanes[l]->is_cuda()) {
      cuda_lanes.push_back(bench.lanes[l]);
      continue;
    }
    std::uint64_t intersects = 0, declined = 0;
    bench.lanes[l]->decide(&pair, 1, &intersects, &declined);
    verdicts[l] = verdict(intersects, declined);
  }
  if (!cuda_lanes.empty()) {
    std::vector<LaneBits> bits;
    bench.device->decide(std::span(&pair, 1), cuda_lanes, bits);
    std::size_t next = 0;
    for (std::size_t l = 0; l < bench.lanes.size(); ++l) {
      if (!bench.lanes[l]->is_cuda()) continue;
      verdicts[l] = verdict(bits[next].intersects[0], bits[next].declined[0]);
      ++next;
    }
  }
  return verdicts;
}

}  // namespace graze
