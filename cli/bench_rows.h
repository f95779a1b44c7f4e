// SPDX-License-Identifier: Apache-2.0
// What `graze bench` measures: queries of arrays of several sizes, by all executors that are here, each the best of
// three, after one that is not counted; and beside them what bounds a device, and CGAL's tree of boxes.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <graze/query.h>

namespace graze::cli {

struct BenchOptions {
  std::vector<std::uint64_t> sizes;
  std::vector<query::Triangle> mesh;  // measured as well, unless empty
  std::string mesh_name;
  std::vector<std::string> lanes;  // beside the exact one
};

struct BenchRow {
  std::size_t group;  // rows of one array
  std::string array;  // "thesis", or the name of a mesh
  std::uint64_t triangles;
  std::string executor;               // "one core", "all cores", "one GPU", "2 GPUs"
  std::string data;                   // "host", "resident"
  std::string mode;                   // "all", "any"
  std::string lane;                   // "exact"; "CGAL AABB tree"
  double seconds, build_seconds = 0;  // of the tree
  std::uint64_t hits;
  std::optional<std::uint64_t> mismatches;  // with the exact lane, of another one

  double rate() const { return static_cast<double>(triangles) / seconds; }  // a second
  std::string by() const { return executor + (data == "resident" ? ", resident" : ""); }
};

struct BenchMachine {
  int cores = 0;
  std::vector<std::string> devices;
  double copy_bytes_per_second = 0, to_device_bytes_per_second = 0;  // of the first device
};

struct Bench {
  BenchMachine machine;
  std::vector<BenchRow> rows;
  // The smallest array, of those measured, from which on one GPU is faster with its copies than all cores; 0: none.
  std::uint64_t crossover = 0;
};

// Tells each row as it is measured, the last one of what there is so far; false ends it.   Throws: std::runtime_error
// of what went wrong.
Bench measure(const BenchOptions& options, const std::function<bool(const Bench&)>& told);

// An SVG of 900 x 420: triangles of the thesis a second, exact, against the size of the array, both by decades; one
// line for each executor. `machine`: its words.
std::string bench_plot(const Bench& bench, const std::string& machine);

}  // namespace graze::cli
