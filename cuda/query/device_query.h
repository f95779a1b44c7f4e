// SPDX-License-Identifier: Apache-2.0
// Compares references with an array of triangles on a device. This header includes no CUDA headers and compiles without
// nvcc.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"
#include "cuda/lanes/device_failure.h"
#include "cuda/lanes/triangles.h"

namespace graze::cuda {

// Triangles [first, first + count) of the array, all in one part. `count` is a multiple of 64 except at the part's end.
struct QueryRange {
  std::uint64_t first = 0, count = 0;
  std::size_t part = 0;
  std::uint64_t first_in_part = 0;
};

// One reference's counts over a range. `first`: the index of the reference's first hit, counted from the range's start.
// In a search for any hit, the first reference's `declined` counts only triangles before the earliest hit of
// any reference.
struct QueryCounts {
  std::uint64_t hits = 0, declined = 0, first = ~std::uint64_t{0};
};

// Hands out ranges and collects the results. Thread-safe.
class QueryWork {
 public:
  virtual ~QueryWork() = default;
  // Takes the next range of at most `most` triangles, from the parts in the memory of `device` (-1: the host).
  // Returns: false if no range is left or needed.
  virtual bool next(int device, std::uint64_t most, QueryRange& range) = 0;
  // Receives the verdicts on a range. Each reference has a row of `words` words; bit i % 64 of word i / 64 belongs to
  // triangle i.
  virtual void take(const QueryRange& range, const std::uint64_t* hits, const std::uint64_t* declined,
                    std::size_t words) = 0;
  // Receives the counts of each reference, if wants_bits() is false.
  virtual void take(const QueryRange& range, std::span<const QueryCounts> counts) = 0;
  virtual bool wants_bits() const = 0;
  // Called after a worker failed. No more ranges are handed out, and nobody waits for missing results.
  virtual void stop() = 0;
};

struct DeviceQuestion {
  bool in_doubles = false;           // the coordinates are doubles, not floats
  const void* references = nullptr;  // nine coordinates for each reference
  std::uint64_t reference_count = 0;
  std::vector<TriangleArray> parts;
  std::vector<int> places;                          // for each part: the device whose memory it is in; -1: the host
  Lane lane;                                        // on a device, a CUDA lane; for doubles, the exact lane
  bool any = false;                                 // stops at the first hit
  unsigned char *bytes = nullptr, *bits = nullptr;  // results in device memory, one row per reference; or null
  std::uint64_t triangles = 0;
  void* stream = nullptr;  // a cudaStream_t on the device of the only part; null: our own streams
  double launch_seconds = 0.5;
};

struct LaunchRecord {
  std::uint64_t chunks = 0;
  double longest = 0;  // seconds that the kernels of the slowest chunk took
};

// A device with memory for its queries. Not thread-safe.
class QueryDevice {
 public:
  virtual ~QueryDevice() = default;
  // Works until no range is left: on the parts in the device's memory if there are any, otherwise on those in host
  // memory. Throws: DeviceFailure.
  virtual LaunchRecord run(const DeviceQuestion& question, QueryWork& work) = 0;
  int number = 0;
  std::string name;  // "NVIDIA H200"
};

// The number of devices. If there is none, `why_not` becomes the reason ("no device", "built without CUDA").
int count_query_devices(std::string& why_not);

// Throws: DeviceFailure.
std::unique_ptr<QueryDevice> open_query_device(int number);

}  // namespace graze::cuda
