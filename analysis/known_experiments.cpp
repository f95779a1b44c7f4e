// SPDX-License-Identifier: Apache-2.0
#include "analysis/known_experiments.h"

#include <map>
#include <mutex>
#include <tuple>

namespace graze::analysis {

Experiment known_experiment(const Lane& lane, Verdict verdict, const AnyPair& pair, Verdict truth) {
  using Key = std::tuple<std::string, Verdict, Verdict, std::string>;
  constexpr std::size_t kMostKnown = 20'000;  // about 20 MB
  static std::map<Key, Experiment> known;
  static std::mutex mutex;
  const auto made_on = [&](const auto& own) { return experiment(lane, verdict, own, truth); };
  if (find_lane(lane.id) != &lane) return visit(pair, made_on);
  const auto bytes = [](const auto& own) { return std::string(reinterpret_cast<const char*>(&own), sizeof own); };
  const Key key{lane.id, verdict, truth, visit(pair, bytes)};
  {
    const std::lock_guard lock(mutex);
    if (const auto found = known.find(key); found != known.end()) return found->second;
  }
  Experiment made = visit(pair, made_on);
  const std::lock_guard lock(mutex);
  if (known.size() >= kMostKnown) known.clear();
  return known.insert_or_assign(key, std::move(made)).first->second;
}

}  // namespace graze::analysis
