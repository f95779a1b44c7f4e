// SPDX-License-Identifier: Apache-2.0
#include "cli/bench_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <thread>

#include "core/error.h"
#include "core/lanes/lanes.h"
#include "cuda/query/device_query.h"
#include "cuda/query/device_rows.h"
#include "oracle/cgal_triangles.h"
#include "strata/strata.h"
#ifdef GRAZE_EMBREE
#include "cli/embree_tree.h"
#endif

namespace graze::cli {
namespace {

using query::Answer;
using query::Triangle;

constexpr std::uint64_t kDrawn = 1'000'000;   // distinct triangles; larger arrays repeat them
constexpr std::uint64_t kInTree = 1'000'000;  // a larger tree would take minutes and gigabytes
constexpr std::uint64_t kByLanes = 1'000'000, kByCudaLanes = 10'000'000;  // limits on triangles for inexact lanes
constexpr std::uint64_t kOnOneCore = 100'000'000, kInDoubles = 100'000'000;
constexpr int kTimes = 3;
constexpr Triangle kThesis = {2, -2, 4, 1, 5, -2, 1, -3, -3};

bool is_foreign(const std::string& id) {
  const Lane* lane = find_lane(id);
  return lane && lane->foreign;
}

// Whether this is a published algorithm's CUDA lane. A user's CUDA lane does not count: it runs in its own process.
bool is_cuda(const std::string& lane) { return lane.find("/cuda") != lane.npos && !is_foreign(lane); }

struct Array {
  std::string name;
  Triangle reference;
  std::vector<Triangle> triangles;
};

Array thesis_array(std::uint64_t count) {
  Array array{"thesis", kThesis, std::vector<Triangle>(count)};
  const std::uint64_t drawn = std::min(count, kDrawn);
  for (std::uint64_t i = 0; i < drawn; ++i) {
    const Pair pair = strata::generate(1, strata::Stratum::thesis, i);
    std::memcpy(array.triangles[i].data(), pair.b, sizeof(Triangle));
  }
  for (std::uint64_t i = drawn; i < count; i += drawn)
    std::copy_n(array.triangles.begin(), std::min(drawn, count - i), array.triangles.begin() + static_cast<long>(i));
  return array;
}

// Returns an array with one hit, among its first hundred triangles.
Array any_array(std::uint64_t count) {
  Array array{"thesis", kThesis, std::vector<Triangle>(count, Triangle{9, 9, 9, 9, 8, 9, 9, 9, 8})};
  array.triangles[std::min<std::uint64_t>(99, count - 1)] = kThesis;
  return array;
}

double seconds_of(const std::function<void()>& run) {
  const auto start = std::chrono::steady_clock::now();
  run();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

class Measuring {
 public:
  Measuring(const BenchOptions& options, const std::function<bool(const Bench&)>& told)
      : options_(options), told_(told), devices_(graze_devices()) {
    bench_.machine.cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    for (int d = 0; d < devices_; ++d) bench_.machine.devices.push_back(cuda::open_query_device(d)->name);
    if (devices_ == 0) return;
    const cuda::DeviceSpeeds speeds = cuda::measure_speeds(0, std::size_t{1} << 32);
    bench_.machine.copy_bytes_per_second = speeds.copy;
    bench_.machine.to_device_bytes_per_second = speeds.to_device;
    bench_.machine.exact_query = cuda::needs_of_exact_query(0);
  }

  Bench operator()() {
    for (const std::uint64_t count : options_.sizes) measure(thesis_array(count));
    if (!options_.mesh.empty()) measure({options_.mesh_name, options_.mesh[options_.mesh.size() / 2], options_.mesh});
    find_crossover();
    return std::move(bench_);
  }

 private:
  void measure(const Array& array) {
    const graze_triangles host = query::rows_of(std::span<const Triangle>(array.triangles));
    std::vector<std::uint8_t> exact(array.triangles.size());
    by_executors(array, host, "all", kExact, exact, nullptr);
    if (host.count <= kInDoubles) by_executors_in_doubles(array, exact);
    for (const std::string& lane : options_.lanes) {
      const std::uint64_t most = is_cuda(lane) && devices_ > 0 ? kByCudaLanes : kByLanes;
      if (host.count <= most)
        by_executors(array, host, "all", lane, exact, &exact);
      else
        bench_.not_timed_above[lane] = most;
    }
    if (array.name == "thesis") {
      const Array with_hit = any_array(array.triangles.size());
      std::vector<std::uint8_t> none;
      by_executors(with_hit, query::rows_of(std::span<const Triangle>(with_hit.triangles)), "any", kExact, none,
                   nullptr);
    }
    if (array.triangles.size() <= kInTree) {
      by_tree<oracle::AabbTree>(array, "CGAL AABB tree");
#ifdef GRAZE_EMBREE
      by_tree<EmbreeTree>(array, "Embree");
#endif
    }
    ++group_;
  }

  void by_executors(const Array& array, const graze_triangles& host, const std::string& mode, const std::string& lane,
                    std::vector<std::uint8_t>& bytes, const std::vector<std::uint8_t>* exact) {
    by_executors(array.name, query::query_of(array.reference, host), sizeof(Triangle), mode, lane, bytes, exact);
  }

  // Measures the exact lane again, with the same numbers stored as doubles.
  void by_executors_in_doubles(const Array& array, std::vector<std::uint8_t>& exact) {
    const auto in_doubles = [](const Triangle& t) {
      query::DoubleTriangle result;
      std::copy(t.begin(), t.end(), result.begin());
      return result;
    };
    const query::DoubleTriangle reference = in_doubles(array.reference);
    std::vector<query::DoubleTriangle> triangles(array.triangles.size());
    std::transform(array.triangles.begin(), array.triangles.end(), triangles.begin(), in_doubles);
    const graze_triangles host = query::rows_of(std::span<const query::DoubleTriangle>(triangles));
    by_executors(array.name, query::query_of(reference, host), sizeof triangles[0], "all", kExactInDoubles, exact,
                 &exact);
  }

  // Writes the lane's verdicts to `bytes` or, if `exact` is given, compares them with `exact`. Each triangle has `size`
  // bytes.
  void by_executors(const std::string& array, graze_query query, std::size_t size, const std::string& mode,
                    const std::string& lane, std::vector<std::uint8_t>& bytes, const std::vector<std::uint8_t>* exact) {
    const graze_triangles host = query.parts[0];
    BenchRow row{group_, array, host.count, "", "host", mode, lane, 0, 0, 0, {}, 0};
    query.mode = mode == "any" ? GRAZE_ANY : GRAZE_ALL;
    const bool by_twin = is_cuda(lane) && devices_ == 0, is_exact = lane == kExact || lane == kExactInDoubles;
    const bool on_host = !is_cuda(lane) || by_twin, on_device = is_exact || !on_host;
    query.lane = is_exact ? nullptr : lane.c_str();
    if (on_host) {
      const std::string twin = by_twin ? ", twin" : is_foreign(lane) ? ", its process" : "";
      if (host.count <= kOnOneCore) add(row, query, GRAZE_ONE_CORE, "one core" + twin, &bytes, exact);
      if (bench_.machine.cores > 1) add(row, query, GRAZE_ALL_CORES, "all cores" + twin, &bytes, exact);
    }
    if (!on_device || devices_ == 0) return;
    add(row, query, GRAZE_ONE_GPU, "one GPU", &bytes, exact);
    if (devices_ > 1) add(row, query, GRAZE_ALL_GPUS, fmt::format("{} GPUs", devices_), &bytes, exact);
    row.data = "resident";
    std::vector<std::unique_ptr<cuda::DeviceMemory>> memories;
    std::vector<graze_triangles> parts;
    for (int d = 0; d < devices_; ++d) {
      memories.push_back(cuda::device_memory(d, host.count * size));
      memories.back()->fill(host.rows, host.count * size);
      parts.push_back(host);
      parts.back().device = d;
      parts.back().rows = memories.back()->data;
      if (d > 0 && mode == "any") break;
    }
    query.parts = parts.data();
    add(row, query, GRAZE_ONE_GPU, "one GPU", nullptr, nullptr);
    if (is_exact && mode == "all") {
      graze_query split = query;
      split.launch_seconds = bench_.rows.back().seconds / 8;
      row.data = "resident, split";
      add(row, split, GRAZE_ONE_GPU, "one GPU", nullptr, nullptr);
      row.data = "resident";
    }
    if (devices_ == 1 || mode == "any") return;
    query.part_count = parts.size();  // all parts: each device has a copy of the array
    row.triangles = host.count * parts.size();
    add(row, query, GRAZE_ALL_GPUS, fmt::format("{} GPUs", devices_), nullptr, nullptr);
  }

  void add(BenchRow row, graze_query query, int executor, const std::string& name, std::vector<std::uint8_t>* bytes,
           const std::vector<std::uint8_t>* exact) {
    row.executor = name;
    query.executor = executor;
    std::vector<std::uint8_t> found;
    if (exact) found.resize(exact->size());
    row.seconds = 1e9;
    for (int k = 0; k <= kTimes; ++k) {
      graze_query asked = query;
      // The first run warms up and writes the verdicts; the later runs only count hits.
      if (k == 0 && bytes && query.mode == GRAZE_ALL) asked.bytes = exact ? found.data() : bytes->data();
      const Answer answer = context_.run(asked);
      if (answer.status == GRAZE_BAD_ARGUMENT) throw UsageError(std::string(answer.what()));
      if (!answer) throw std::runtime_error(fmt::format("{}, {}: {}", name, row.lane, answer.what()));
      row.hits = answer.hits;
      if (k > 0) row.seconds = std::min(row.seconds, answer.seconds);
    }
    if (row.lane == kExact && row.mode == "all") expect_hits(row);
    if (exact) {
      row.mismatches = 0;
      for (std::size_t i = 0; i < found.size(); ++i) *row.mismatches += found[i] != (*exact)[i];
    }
    tell(row);
  }

  // Checks that all executors find the same hits in an array. If each device holds its own copy, hits and triangles are
  // counted once per copy, so their ratios are compared.
  void expect_hits(const BenchRow& row) const {
    for (const BenchRow& other : bench_.rows) {
      if (other.group != row.group || other.lane != kExact || other.mode != "all") continue;
      if (other.hits * row.triangles == row.hits * other.triangles) continue;
      throw std::runtime_error(fmt::format("{} and {} disagree: {} hits among {} triangles, {} among {}",
                                           other.executor, row.executor, other.hits, other.triangles, row.hits,
                                           row.triangles));
    }
  }

  template <class Tree>
  void by_tree(const Array& array, const char* name) {
    std::optional<Tree> tree;
    BenchRow row{group_, array.name, array.triangles.size(), "one core", "host", "all", name, 1e9, 0, 0, {}, 0};
    row.build_seconds = seconds_of([&] { tree.emplace(array.triangles); });
    for (int k = 0; k < kTimes; ++k)
      row.seconds = std::min(row.seconds, seconds_of([&] { row.hits = tree->count(array.reference); }));
    tell(row);
  }

  void tell(const BenchRow& row) {
    bench_.rows.push_back(row);
    if (!told_(bench_)) throw std::runtime_error("interrupted");
  }

  void find_crossover() {
    const auto time_of = [&](const BenchRow& like, const char* executor) {
      for (const BenchRow& row : bench_.rows) {
        if (row.array == "thesis" && row.triangles == like.triangles && row.lane == kExact && row.mode == "all" &&
            row.data == "host" && row.executor == executor)
          return row.seconds;
      }
      return 0.0;
    };
    for (const BenchRow& row : bench_.rows) {
      if (row.executor != "one GPU" || row.data != "host") continue;
      const double cores = time_of(row, "all cores"), device = time_of(row, "one GPU");
      if (cores == 0 || device == 0) continue;
      if (device >= cores) {
        bench_.crossover = 0;
      } else if (bench_.crossover == 0) {
        bench_.crossover = row.triangles;
      }
    }
  }

  const BenchOptions& options_;
  const std::function<bool(const Bench&)>& told_;
  int devices_;
  std::size_t group_ = 0;
  query::Context context_;
  Bench bench_;
};

}  // namespace

Bench measure(const BenchOptions& options, const std::function<bool(const Bench&)>& told) {
  return Measuring(options, told)();
}

}  // namespace graze::cli
