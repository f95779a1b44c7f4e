// SPDX-License-Identifier: Apache-2.0
#include "fuzz/selected_lanes.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "backends/backends.h"
#include "core/error.h"
#include "core/text.h"

namespace graze::fuzz {
namespace {

using backends::Backend, backends::backend_of;

// Why the lane does not run here; empty if it runs.
std::string why_unavailable(const Lane& lane, const cuda::Device* device, const std::string& why_no_device) {
  const Backend& backend = backend_of(lane);
  return device && backend.has_device ? "" : backend.why_not_on_host(lane, why_no_device);
}

// The lane's function on the host; null if only the device runs the lane.
DecideBlock host_block(const SelectedLanes& under_test, const Lane& lane) {
  const Backend& backend = backend_of(lane);
  return backend.has_device && under_test.device && !under_test.twins_too ? nullptr : backend.on_host(lane);
}

// Sorts the lanes and their functions by place(lane). Lanes with the same place keep their order.
template <class Place>
void sort_lanes(SelectedLanes& under_test, const Place& place) {
  std::vector<std::size_t> order(under_test.lanes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t l, std::size_t r) {
    return place(*under_test.lanes[l]) < place(*under_test.lanes[r]);
  });
  SelectedLanes sorted;
  for (const std::size_t l : order) {
    sorted.lanes.push_back(under_test.lanes[l]);
    sorted.on_host.push_back(under_test.on_host[l]);
  }
  under_test.lanes = std::move(sorted.lanes);
  under_test.on_host = std::move(sorted.on_host);
}

// Moves each lane with a policy from the end of the table to the other lanes of its subject.
void sort_by_subject(SelectedLanes& under_test) {
  std::map<const AlgorithmInfo*, std::size_t> places;
  for (const Lane* lane : under_test.lanes) places.emplace(lane->info, places.size());
  sort_lanes(under_test, [&](const Lane& lane) { return places.at(lane.info); });
}

bool wants_lanes(const std::string& pattern) { return !pattern.starts_with(kLeaveOut); }

// Names the hardware that would run the lane, given the reason why it does not run here.
std::string_view remedy(std::string_view why) {
  return why.find("no twin") != why.npos  ? "; a CUDA device runs it"
         : why.ends_with(" instructions") ? "; a processor with them runs it"
                                          : "";
}

}  // namespace

std::vector<const Lane*> SelectedLanes::device_lanes() const {
  std::vector<const Lane*> result;
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    if (on_device(l)) result.push_back(lanes[l]);
  }
  return result;
}

void SelectedLanes::keep_if(const std::function<bool(const Lane&)>& keep) {
  std::size_t kept = 0;
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    if (!keep(*lanes[l])) continue;
    lanes[kept] = lanes[l];
    on_host[kept++] = on_host[l];
  }
  lanes.resize(kept);
  on_host.resize(kept);
}

std::string SelectedLanes::evidence(std::size_t l) const {
  const std::string here = on_host[l] ? backend_of(*lanes[l]).evidence(*lanes[l], of_doubles) : "";
  return !on_device(l) ? here : here.empty() ? "device" : "device and " + here;
}

std::string status(const Lane& lane, const cuda::Device* device, const std::string& why_no_device) {
  if (const std::string why = why_unavailable(lane, device, why_no_device); !why.empty())
    return "unavailable (" + why + ")";
  const Backend& backend = backend_of(lane);
  const std::string by = device && backend.has_device ? "device" : backend.evidence(lane, false);
  return by.empty() ? "available" : "available (" + by + ")";
}

void expect_each_runs(const SelectedLanes& under_test) {
  std::vector<std::string> patterns = under_test.asked;
  std::erase_if(patterns, [](const std::string& pattern) { return !wants_lanes(pattern); });
  if (patterns.empty()) {
    for (const LaneLeftOut& row : under_test.left_out) {
      if (find_lane(row.id)) patterns.push_back(row.id.substr(0, row.id.find('/')) + "/*");
    }
  }
  for (const std::string& pattern : patterns) {
    if (std::any_of(under_test.lanes.begin(), under_test.lanes.end(),
                    [&](const Lane* lane) { return matches_any({pattern}, lane->id); }))
      continue;
    std::vector<LaneLeftOut> of_pattern;
    for (const LaneLeftOut& row : under_test.left_out) {
      if (matches_any({pattern}, row.id)) of_pattern.push_back(row);
    }
    throw UsageError(fmt::format("no lane of '{}' runs here: {}", printable(pattern),
                                 fmt::join(left_out_in_words(of_pattern), "; ")));
  }
}

std::vector<LaneLeftOut> leave_out(SelectedLanes& under_test, const std::function<std::string(const Lane&)>& why) {
  std::vector<LaneLeftOut> taken;
  under_test.keep_if([&](const Lane& lane) {
    const std::string reason = why(lane);
    if (!reason.empty()) taken.push_back({lane.id, reason});
    return reason.empty();
  });
  under_test.left_out.insert(under_test.left_out.end(), taken.begin(), taken.end());
  expect_each_runs(under_test);
  return taken;
}

std::vector<std::string> left_out_in_words(const std::vector<LaneLeftOut>& left_out) {
  std::vector<std::pair<std::string, std::string>> by_reason;
  for (const LaneLeftOut& row : left_out) {
    const auto found = std::find_if(by_reason.begin(), by_reason.end(), [&](auto& r) { return r.first == row.why; });
    if (found == by_reason.end()) {
      by_reason.emplace_back(row.why, row.id);
    } else {
      found->second += ", " + row.id;
    }
  }
  std::vector<std::string> lines;
  for (const auto& [why, ids] : by_reason) lines.push_back(fmt::format("left out ({}{}): {}", why, remedy(why), ids));
  return lines;
}

nlohmann::ordered_json left_out_json(const SelectedLanes& under_test) {
  if (under_test.left_out.empty()) return nullptr;
  nlohmann::ordered_json why = nlohmann::ordered_json::object();
  for (const LaneLeftOut& row : under_test.left_out) why[row.id] = row.why;
  return {{"patterns", under_test.asked}, {"why", why}};
}

void add_left_out(nlohmann::ordered_json& object, const SelectedLanes& under_test) {
  if (!under_test.left_out.empty()) object["lanes_left_out"] = left_out_json(under_test);
}

std::vector<LaneLeftOut> left_out_of(const nlohmann::ordered_json& recorded) {
  std::vector<LaneLeftOut> rows;
  for (const auto& [id, why] : recorded.at("why").items()) rows.push_back({id, why});
  return rows;
}

std::vector<std::string> with_exact_lane(std::vector<std::string> patterns) {
  const auto names_it = [](const std::string& pattern) {
    return matches_any({pattern.starts_with(kLeaveOut) ? pattern.substr(1) : pattern}, kExactLane);
  };
  if (std::any_of(patterns.begin(), patterns.end(), wants_lanes) &&
      std::none_of(patterns.begin(), patterns.end(), names_it))
    patterns.push_back(kExactLane);
  return patterns;
}

void expect_each_matches(const std::vector<std::string>& patterns, const std::vector<LaneLeftOut>& not_opened) {
  for (const std::string& pattern : patterns) {
    const bool leaves_out = pattern.starts_with(kLeaveOut);
    const std::string glob = pattern.substr(leaves_out ? 1 : 0);
    if (!leaves_out) add_policy_lanes(glob);
    const auto matches = [&](const auto& row) { return matches_any({glob}, row.id); };
    if (std::any_of(lanes().begin(), lanes().end(), matches) ||
        std::any_of(not_opened.begin(), not_opened.end(), matches))
      continue;
    std::vector<std::string> ids;
    for (const Lane& lane : lanes()) ids.push_back(lane.id);
    throw UsageError("no lane matches '" + printable(glob) + "'; `graze lanes` lists them" + did_you_mean(glob, ids));
  }
}

SelectedLanes select_lanes(const std::vector<std::string>& globs, Executor executor, bool require_device,
                           const std::vector<LaneLeftOut>& not_opened) {
  expect_each_matches(globs, not_opened);
  const bool names_some = std::any_of(globs.begin(), globs.end(), wants_lanes);
  SelectedLanes under_test;
  under_test.asked = globs;
  under_test.twins_too = executor == Executor::both;
  std::string why_not;
  if (executor != Executor::twin) under_test.device = cuda::open_device(why_not);
  const bool needs_device = require_device || executor == Executor::device || executor == Executor::both;
  if (needs_device && !under_test.device)
    throw std::runtime_error("a CUDA device is required, but none can be used: " + why_not);
  for (const Lane& lane : lanes()) {
    if (!matches_any(globs, lane.id)) continue;
    const auto names_it = [&](const std::string& glob) {
      return glob.starts_with("exact/f64/") && matches_any({glob}, lane.id);
    };
    if (is_exact_on_doubles(lane) && std::none_of(globs.begin(), globs.end(), names_it)) continue;
    const std::string why = why_unavailable(lane, under_test.device.get(), why_not);
    if (why.empty()) {
      under_test.lanes.push_back(&lane);
      under_test.on_host.push_back(host_block(under_test, lane));
    } else if (names_some || lane.foreign) {
      under_test.left_out.push_back({lane.id, why});
    }
  }
  for (const LaneLeftOut& row : not_opened) {
    if (matches_any(globs, row.id)) under_test.left_out.push_back(row);
  }
  sort_by_subject(under_test);
  if (under_test.lanes.empty()) {
    if (under_test.left_out.empty()) throw UsageError("the patterns of --lanes leave no lane");
    throw UsageError(fmt::format("none of the selected lanes runs here: {}",
                                 fmt::join(left_out_in_words(under_test.left_out), "; ")));
  }
  return under_test;
}

void put_own_code_first(SelectedLanes& under_test) {
  sort_lanes(under_test, [](const Lane& lane) { return !lane.foreign; });
}

bool takes(const Lane& lane, const AnyPair& pair) {
  return pair.floats || lane.scalar == Scalar::f32 || backends::on_host(lane).decides_doubles();
}

void add_exact_on_doubles(SelectedLanes& under_test) {
  for (const Lane& lane : lanes()) {
    if (!is_exact_on_doubles(lane) || !matches_any(under_test.asked, lane.id) ||
        std::find(under_test.lanes.begin(), under_test.lanes.end(), &lane) != under_test.lanes.end())
      continue;
    under_test.lanes.push_back(&lane);
    under_test.on_host.push_back(host_block(under_test, lane));
  }
  sort_by_subject(under_test);
  under_test.of_doubles = true;
}

std::vector<LaneLeftOut> select_for_doubles(SelectedLanes& under_test) {
  add_exact_on_doubles(under_test);
  return leave_out(under_test, [&](const Lane& lane) {
    const bool by_device = under_test.device && backend_of(lane).has_device;
    return by_device || takes(lane, DoublePair{}) ? "" : "takes only pairs of float32";
  });
}

BlockVerdicts::BlockVerdicts(const SelectedLanes& under_test)
    : under_test_(under_test), on_host_(under_test.lanes.size()), verdicts_(under_test.lanes.size()) {}

std::span<const LaneVerdicts> BlockVerdicts::decide(std::span<const Pair> pairs, std::span<const VerdictBits> on_device,
                                                    std::size_t begin,
                                                    const std::function<void(std::size_t l, std::size_t i)>& apart,
                                                    std::span<const DoublePair> doubles) {
  const std::size_t words = (pairs.size() + 63) / 64;
  auto next_device = on_device.begin();
  for (std::size_t l = 0; l < verdicts_.size(); ++l) {
    const DecideBlock& block = under_test_.on_host[l];
    if (block) {
      const bool in_doubles =
          !doubles.empty() && under_test_.lanes[l]->scalar == Scalar::f64 && block.decides_doubles();
      in_doubles ? graze::decide(block, doubles, on_host_[l]) : graze::decide(block, pairs, on_host_[l]);
      verdicts_[l] = {on_host_[l].intersects, on_host_[l].declined, under_test_.lanes[l]->foreign ? &block : nullptr,
                      pairs.data(), in_doubles ? doubles.data() : nullptr};
    }
    if (!under_test_.on_device(l)) continue;
    const LaneVerdicts twin = verdicts_[l];
    const auto words_of = [&](std::span<const std::uint64_t> bits) { return bits.subspan(begin / 64, words); };
    const bool in_doubles = !doubles.empty() && under_test_.lanes[l]->scalar == Scalar::f64;
    verdicts_[l] = {words_of(next_device->intersects), words_of(next_device->declined), nullptr, nullptr,
                    in_doubles ? doubles.data() : nullptr};
    ++next_device;
    for (std::size_t i = 0; block && i < pairs.size(); ++i) {
      if (verdicts_[l].at(i) != twin.at(i)) apart(l, i);
    }
  }
  return verdicts_;
}

std::vector<Verdict> decide(const SelectedLanes& under_test, const AnyPair& any, std::vector<const Lane*>& apart) {
  apart.clear();
  const Pair pair = any.in_float32();
  const std::span<const DoublePair> doubles(&any.doubles, any.floats ? 0 : 1);
  std::vector<VerdictBits> on_device;
  if (under_test.device) under_test.device->decide(std::span(&pair, 1), under_test.device_lanes(), on_device, doubles);
  BlockVerdicts block(under_test);
  std::vector<Verdict> verdicts;
  const auto differs = [&](std::size_t l, std::size_t) { apart.push_back(under_test.lanes[l]); };
  for (const LaneVerdicts& lane : block.decide(std::span(&pair, 1), on_device, 0, differs, doubles))
    verdicts.push_back(lane.at(0));
  return verdicts;
}

}  // namespace graze::fuzz
