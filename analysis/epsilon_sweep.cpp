// SPDX-License-Identifier: Apache-2.0
#include "analysis/epsilon_sweep.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "analysis/curves.h"

namespace graze::analysis {
namespace {

constexpr std::size_t kTogether = 4;  // epsilon values whose processes run at once

}  // namespace

std::unique_ptr<subjects::ForeignProcesses> UnderEpsilon::operator()(const std::string& policy) {
  std::unique_ptr<subjects::ForeignProcesses>& built = built_[policy];
  if (!built) {
    built = subjects::rebuilt(
        lane_, subjects::with_value(source_.text, {source_.epsilon}, tolerance_of(policy), source_.language),
        lane_.scalar);
  }
  return built->anew();
}

LaneDecider EpsilonDeciders::operator()(const std::string& policy) {
  if (policy.empty()) return decider_of(under_.lane());
  std::unique_ptr<subjects::ForeignProcesses>& processes = running_[policy];
  if (!processes) processes = under_(policy);
  return {*processes, &under_.lane()};
}

Sweep epsilon_sweep(UnderEpsilon& under, int threads) {
  return [&under, threads](Policies policies, Sources sources) {
    std::vector<PolicyErrors> errors;
    for (std::size_t first = 0; first < policies.size(); first += kTogether) {
      EpsilonDeciders decide(under);
      const Policies some = policies.subspan(first, std::min(kTogether, policies.size() - first));
      for (PolicyErrors& of_policy : host_sweep(std::ref(decide), threads)(some, sources))
        errors.push_back(std::move(of_policy));
    }
    return errors;
  };
}

}  // namespace graze::analysis
