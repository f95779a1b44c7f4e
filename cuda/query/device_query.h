// SPDX-License-Identifier: Apache-2.0
// Compares references with an array of triangles on a device. This header needs no CUDA header, and building it needs
// no nvcc.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "core/lanes/lanes.h"
#include "cuda/lanes/device_failure.h"
#include "cuda/lanes/triangles.h"

namespace graze::cuda {

// Triangles [first, first + count) of the array. They lie in one part; `count` is a multiple of 64 except at the part's
// end.
struct QueryRange {
  std::uint64_t first = 0, count = 0;
  std::size_t part = 0;
  std::uint64_t first_in_part = 0;
};

// Counts for one reference over a range; index 0 is the range's first triangle. In a search for any hit, the first
// reference's `declined` counts only the triangles before the first hit of all references.
struct QueryCounts {
  std::uint64_t hits = 0, declined = 0, first = ~std::uint64_t{0};
};

// Hands out ranges and collects the results. Thread-safe.
class QueryWork {
 public:
  virtual ~QueryWork() = default;
  // Takes the next range of at most `most` triangles, from the parts in the memory of `device` (-1: the host).
  // Returns: false when there is none left, or no more is needed.
  virtual bool next(int device, std::uint64_t most, QueryRange& range) = 0;
  // The verdicts as bits: bit i % 64 of word i / 64, a row of `words` words for each reference.
  virtual void take(const QueryRange& range, const std::uint64_t* hits, const std::uint64_t* declined,
                    std::size_t words) = 0;
  // Used instead where wants_bits() is false: the counts for each reference.
  virtual void take(const QueryRange& range, std::span<const QueryCounts> counts) = 0;
  virtual bool wants_bits() const = 0;
  // Called when a worker failed: hands out no more ranges, and does not wait for missing ones.
  virtual void stop() = 0;
};

struct DeviceQuestion {
  bool in_doubles = false;           // the coordinates are doubles, not floats
  const void* references = nullptr;  // nine coordinates for each reference
  std::uint64_t reference_count = 0;
  std::span<const TriangleArray> parts;
  std::span<const int> places;  // for each part: the device whose memory holds it, -1: host
  const Lane* lane = nullptr;   // a CUDA lane; the exact one for doubles
  bool any = false;
  unsigned char *bytes = nullptr, *bits = nullptr;  // device memory or null; a row for each reference
  std::uint64_t triangles = 0;
  void* stream = nullptr;  // a cudaStream_t on the device of the only part; null: our own stream
  double launch_seconds = 0.5;
};

struct LaunchRecord {
  std::uint64_t chunks = 0;
  double longest = 0;  // seconds that the kernels of the slowest chunk took
};

// A device with the memory that its queries need. Not thread-safe.
class QueryDevice {
 public:
  virtual ~QueryDevice() = default;
  // Works until no range is left: on the parts in its own memory if there are any, else on the parts in host memory.
  // Throws: DeviceFailure.
  virtual LaunchRecord run(const DeviceQuestion& question, QueryWork& work) = 0;
  int number = 0;
  std::string name;  // "NVIDIA H200"
};

// The number of devices. If 0, `why_not` has the reason ("no device", "built without CUDA").
int count_query_devices(std::string& why_not);

// Throws: DeviceFailure.
std::unique_ptr<QueryDevice> open_query_device(int number);

}  // namespace graze::cuda
