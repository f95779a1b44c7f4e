// SPDX-License-Identifier: Apache-2.0
// Compares the values that two lanes of one algorithm and scalar compute: how much they differ, which is nearer to the
// exact value, and whether a sign, a comparison or the verdict differs. core/discrepancy/count.h describes the counts.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/any_pair.h"
#include "core/discrepancy/led.h"
#include "core/discrepancy/questions.h"
#include "core/lanes/records.h"
#include "strata/pair_source.h"

namespace graze::analysis {

// Counts in the layout of core/discrepancy/count.h. Pairs that are not finite are not counted.
struct DiscrepancyCounts {
  std::vector<std::uint64_t> counts;
  std::vector<std::uint64_t> maxima;  // bits of doubles; band_maxima::kFields for each question
  // For each lane, the pairs on which the verdict of its recorded run, compiled separately, differs from its own.
  std::uint64_t unlike[2] = {0, 0};

  explicit DiscrepancyCounts(int algorithm = 0);
  DiscrepancyCounts& operator+=(const DiscrepancyCounts& other);
  friend bool operator==(const DiscrepancyCounts&, const DiscrepancyCounts&) = default;
};

// Records a lane's values on the host, from the lane or its twin. Null if neither can record.
RecordBlock record_on_host(const Lane& lane);

// Why the values of two lanes cannot be compared on the host. Empty if both lanes have the same algorithm and scalar,
// and record their values.
std::string why_not_compared(const Lane& l, const Lane& r);

// Two lanes to compare. Their values are recorded on the host. Lanes in float are compared only on pairs of float32,
// lanes in double on pairs of either type.
struct LanesCompared {
  const Lane *first, *second;

  // Throws: UsageError with why_not_compared.
  LanesCompared(const Lane& l, const Lane& r);
};

// If one of the lanes is a contracted CUDA lane and the other rounds every operation, returns the contracted lane.
// Otherwise returns null.
const Lane* fused_of(const Lane& l, const Lane& r);

// A value that at least one of two lanes compares. Values are in the order of the first lane's run, followed by those
// that only the second lane compares.
struct ValueBeside {
  int question, which;                  // which: index in Question::of
  std::optional<double> first, second;  // nothing if the lane did not compute it
  bool compared = false;                // both lanes computed the same quantity
  std::optional<Unrounded> unrounded;   // along the first lane's path; empty if only the second lane has the value
};

// The runs of two lanes on one pair.
struct RunsBeside {
  std::vector<ValueBeside> values;
  RecordedPath first, second;
};

// Requires: a finite pair; a pair of doubles only for lanes in double.
RunsBeside runs_beside(const LanesCompared& lanes, const AnyPair& pair);

// The bucket of a lane's error in ulps, "0", "1/2", "2^k", "not finite" or "unknown"; as in core/discrepancy/count.h.
std::string error_bucket_of(Scalar scalar, double value, const Certified& exact);
std::string error_bucket_name(int bucket);

// The distance of two finite values in ulps of the scalar.
std::uint64_t ulps_apart(Scalar scalar, double first, double second);

struct DiscrepancySpec {
  std::vector<LanesCompared> lanes;
  std::vector<strata::PairSource> sources;
  int threads = 0;         // 0: one for each core
  bool on_device = false;  // whether comparisons run on the device if it can record both lanes
};

// counts[comparison][source]. The counts are the same on host and device, and for any number of threads. On a device,
// the cuda-nofma kernels compute a host lane's values. If the other lane is cuda-nofma itself, the host also computes
// the host lane's values; if any bit differs, the comparison runs on the host.
// Requires: no source of doubles if a lane is in float.
using Discrepancies = std::vector<std::vector<DiscrepancyCounts>>;
Discrepancies discrepancies(const DiscrepancySpec& spec);

// Counts one block of pairs.   axis: the axis of the pairs' stratum.
void count_discrepancies(const LanesCompared& lanes, std::span<const Pair> pairs, Axis axis, DiscrepancyCounts& to);
// Requires: lanes in double.
void count_discrepancies(const LanesCompared& lanes, std::span<const DoublePair> pairs, Axis axis,
                         DiscrepancyCounts& to);

}  // namespace graze::analysis
