// SPDX-License-Identifier: Apache-2.0
// The measurements of `graze bench`: queries on arrays of several sizes with all available executors. Each time is the
// best of three runs after a warm-up. Also measures a device's limits and CGAL's AABB tree.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <graze/query.h>

#include "cuda/lanes/device_costs.h"

namespace graze::cli {

inline constexpr const char *kExact = "exact", *kExactInDoubles = "exact, doubles";

struct BenchOptions {
  std::vector<std::uint64_t> sizes;
  std::vector<query::Triangle> mesh;  // measured as well, unless it is empty
  std::string mesh_name;
  std::vector<std::string> lanes;  // in addition to the exact lane
};

struct BenchRow {
  std::size_t group;  // identifies the rows of one array
  std::string array;  // "thesis", or the name of a mesh
  std::uint64_t triangles;
  std::string executor;               // "one core", "all cores", "one GPU", "2 GPUs"; "one core, twin"
  std::string data;                   // "host", "resident"; "resident, split": in about eight launches
  std::string mode;                   // "all", "any"; "between" for two meshes
  std::string lane;                   // kExact, kExactInDoubles; "CGAL AABB tree"; "boxes alone"
  double seconds, build_seconds = 0;  // build_seconds: time to build the tree
  std::uint64_t hits;
  std::optional<std::uint64_t> mismatches;  // triangles on which this lane differs from the exact lane
  double processor_seconds = 0;             // sum over all threads; measured only between two meshes

  double rate() const { return static_cast<double>(triangles) / seconds; }  // triangles per second
  std::string by() const { return data == "host" ? executor : executor + ", " + data; }
};

struct BenchMachine {
  int cores = 0;
  std::vector<std::string> devices;
  // The following members describe the first device.
  double copy_bytes_per_second = 0, to_device_bytes_per_second = 0;
  cuda::KernelNeeds exact_query;
};

struct Bench {
  BenchMachine machine;
  std::vector<BenchRow> rows;
  // The smallest measured array size from which on one GPU, even with copies, is always faster than all cores; 0: none.
  std::uint64_t crossover = 0;
  std::map<std::string, std::uint64_t> not_timed_above;  // by lane: the size of the largest array on which it is timed
};

// Calls `told` with the results so far after each row; `told` returns false to stop.
// Throws: std::runtime_error if a measurement fails.
Bench measure(const BenchOptions& options, const std::function<bool(const Bench&)>& told);

// Adds the rows for two meshes that are tested against each other. `told` works as in `measure`.
// Throws: Stopped; std::runtime_error for a mesh that cannot be read; what `measure` throws.
void measure_between(const std::vector<std::string>& files, Bench& bench,
                     const std::function<bool(const Bench&)>& told);

// Returns an SVG (900 x 420) that plots triangles per second against array size on the thesis arrays, for the exact
// lane and the thesis's own algorithm. Both axes are logarithmic; each lane has a line for each executor. Twins are not
// drawn, because their time is not the lane's. `machine`: a description of the machine.
std::string bench_plot(const Bench& bench, const std::string& machine);

}  // namespace graze::cli
