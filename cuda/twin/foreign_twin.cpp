// SPDX-License-Identifier: Apache-2.0
// The twins of users' CUDA code, which cuda/subject builds as libraries, and functions for both these twins and ours.
#include <map>
#include <memory>
#include <stdexcept>

#include "cuda/twin/twin.h"
#include "cuda/twin/twin_library.h"

namespace graze::cuda {
namespace {

// The twin of a user's CUDA code. foreign_twins() maps lane ids to these twins.
struct ForeignTwin {
  std::unique_ptr<TwinLibrary> library;
  double most_seconds = 0;
};

std::map<std::string, ForeignTwin>& foreign_twins() {
  static std::map<std::string, ForeignTwin> all;
  return all;
}

}  // namespace

void add_foreign_twin(const Lane& lane, const std::string& twin, double most_seconds) {
  ForeignTwin& added = foreign_twins()[lane.id];
  added.most_seconds = most_seconds;
  added.library = std::make_unique<TwinLibrary>(twin, lane.scalar);
}

double most_seconds(const Lane& lane) { return foreign_twins().at(lane.id).most_seconds; }

std::span<const ContractionSite> contraction_sites(const Lane& lane) {
  if (!lane.foreign) return twin_row(lane).sites;
  const auto found = foreign_twins().find(lane.id);
  return found == foreign_twins().end() ? std::span<const ContractionSite>() : found->second.library->sites();
}

std::span<const ContractionSite> contraction_sites(const Lane& lane, const AnyPair& pair) {
  return pair.floats || lane.foreign ? contraction_sites(lane) : twin_row(lane).doubles.sites;
}

std::span<const ComparisonSite> comparison_sites(const Lane& lane) {
  const auto found = foreign_twins().find(lane.id);
  return found == foreign_twins().end() ? std::span<const ComparisonSite>() : found->second.library->comparisons();
}

Verdict decide_comparing(const Lane& lane, const AnyPair& pair, std::span<const std::uint64_t> fused,
                         std::span<Comparison> made, std::size_t& count) {
  const int answer = foreign_twins().at(lane.id).library->decide_fusing(pair, fused, made, &count);
  return answer < 0 ? Verdict::declined : answer > 0 ? Verdict::intersects : Verdict::disjoint;
}

Verdict decide_fusing(const Lane& lane, const AnyPair& pair, std::span<const std::uint64_t> fused) {
  std::size_t none = 0;
  if (lane.foreign) return decide_comparing(lane, pair, fused, {}, none);
  const auto decide = [&](const auto& twin, const auto& own) {
    if (!twin.decide_fusing || fused.size() * 64 < twin.sites.size())
      throw std::invalid_argument("decide_fusing: the lane has no such twin, or there are too few bits for its sites");
    return twin.decide_fusing(own, fused.data());
  };
  const TwinRow& row = twin_row(lane);
  return pair.floats ? decide(row, *pair.floats) : decide(row.doubles, pair.doubles);
}

}  // namespace graze::cuda
