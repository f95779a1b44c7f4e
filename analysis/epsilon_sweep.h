// SPDX-License-Identifier: Apache-2.0
// Runs a user's code with different values of its epsilon. The source is rebuilt for each value.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "analysis/sweep.h"
#include "subjects/rebuilt.h"

namespace graze::analysis {

// The lane's code under a policy "abs:VALUE", where VALUE is the epsilon's value; the empty policy is the unchanged
// source. Each value is built once.
class UnderEpsilon {
 public:
  // Requires: a lane and a source that outlive this.
  UnderEpsilon(const Lane& lane, const subjects::TunableSource& source) : lane_(lane), source_(source) {}

  // Returns: processes that nothing else uses.   Throws: as subjects::rebuilt.   Requires: a policy that is not empty.
  std::unique_ptr<subjects::ForeignProcesses> operator()(const std::string& policy);

  const Lane& lane() const { return lane_; }

 private:
  const Lane& lane_;
  const subjects::TunableSource& source_;
  std::map<std::string, std::unique_ptr<subjects::ForeignProcesses>> built_;  // by policy; never started
};

// Decides under each policy. The processes live as long as this object. The empty policy is the lane itself.
class EpsilonDeciders {
 public:
  explicit EpsilonDeciders(UnderEpsilon& under) : under_(under) {}
  LaneDecider operator()(const std::string& policy);

 private:
  UnderEpsilon& under_;
  std::map<std::string, std::unique_ptr<subjects::ForeignProcesses>> running_;
};

// The errors of the code under each policy.   Requires: `under` outlives the sweep.
Sweep epsilon_sweep(UnderEpsilon& under, int threads = 0);

}  // namespace graze::analysis
