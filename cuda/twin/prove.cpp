// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/prove.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace graze::cuda {
namespace {

template <class... Field>
std::uint64_t total(const LaneProof& lane, Field... field) {
  std::uint64_t sum = 0;
  for (const StratumProof& stratum : lane.strata) sum += ((stratum.*field) + ...);
  return sum;
}

}  // namespace

std::uint64_t LaneProof::pairs() const { return total(*this, &StratumProof::pairs); }
std::uint64_t LaneProof::differences() const {
  return total(*this, &StratumProof::verdict_differences, &StratumProof::trace_differences);
}
std::uint64_t LaneProof::twin_pairs() const { return total(*this, &StratumProof::twin_pairs); }
std::uint64_t LaneProof::twin_differences() const {
  return total(*this, &StratumProof::twin_verdict_differences, &StratumProof::twin_trace_differences);
}
bool ProofRecord::verified() const {
  return !lanes.empty() &&
         std::all_of(lanes.begin(), lanes.end(), [](const LaneProof& lane) { return lane.verified(); });
}

nlohmann::ordered_json to_json(const ProofRecord& record) {
  nlohmann::ordered_json lanes = nlohmann::ordered_json::array();
  for (const LaneProof& lane : record.lanes) {
    nlohmann::ordered_json strata = nlohmann::ordered_json::array();
    for (const StratumProof& s : lane.strata) {
      strata.push_back({{"stratum", s.stratum},
                        {"pairs", s.pairs},
                        {"verdict_differences", s.verdict_differences},
                        {"trace_differences", s.trace_differences},
                        {"twin_pairs", s.twin_pairs},
                        {"twin_verdict_differences", s.twin_verdict_differences},
                        {"twin_trace_differences", s.twin_trace_differences}});
      if (!s.examples.empty()) strata.back()["examples"] = s.examples;
    }
    lanes.push_back({{"lane", lane.lane},
                     {"hash", lane.hash},
                     {"trace_hash", lane.trace_hash},
                     {"pairs", lane.pairs()},
                     {"differences", lane.differences()},
                     {"twin_pairs", lane.twin_pairs()},
                     {"twin_differences", lane.twin_differences()},
                     {"strata", std::move(strata)}});
  }
  return {{"device", record.device}, {"driver", record.driver},   {"toolkit", record.toolkit},
          {"seed", record.seed},     {"seconds", record.seconds}, {"lanes", std::move(lanes)}};
}

}  // namespace graze::cuda
