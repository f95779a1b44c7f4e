// SPDX-License-Identifier: Apache-2.0
// References against an array of triangles on a device, as the host sees it; needs neither CUDA headers nor nvcc.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "core/lanes/lanes.h"
#include "cuda/lanes/device_failure.h"
#include "cuda/query/triangles.h"

namespace graze::cuda {

// Triangles [first, first + count) of all; they lie in one part, and count is a multiple of 64 except at its end.
struct QueryRange {
  std::uint64_t first = 0, count = 0;
  std::size_t part = 0;
  std::uint64_t first_in_part = 0;
};

// Of one reference and the triangles of a range, whose first one is place 0. In a search for any hit the first
// reference's `declined` counts those before the first hit of all.
struct QueryCounts {
  std::uint64_t hits = 0, declined = 0, first = ~std::uint64_t{0};
};

// Hands out ranges and takes what was found; for many threads at once.
class QueryWork {
 public:
  virtual ~QueryWork() = default;
  // The next range, of at most so many triangles, for whoever works on the parts in this memory: device -1 is the
  // host's.   Returns: false when there is none, or none is wanted any more.
  virtual bool next(int device, std::uint64_t most, QueryRange& range) = 0;
  // Bit i % 64 of word i / 64 of each reference's row of `words` words.
  virtual void take(const QueryRange& range, const std::uint64_t* hits, const std::uint64_t* declined,
                    std::size_t words) = 0;
  // Instead, where wants_bits() is false: the counts of each reference.
  virtual void take(const QueryRange& range, std::span<const QueryCounts> counts) = 0;
  virtual bool wants_bits() const = 0;
  // No more ranges, and no waiting for those that are missing: somebody failed.
  virtual void stop() = 0;
};

struct DeviceQuestion {
  std::span<const float> references;  // nine each
  std::span<const TriangleArray> parts;
  std::span<const int> places;  // of each part: the device it lies on, -1: host
  const Lane* lane = nullptr;   // a CUDA lane
  bool any = false;
  unsigned char *bytes = nullptr, *bits = nullptr;  // in the memory of the device, or null; rows of all triangles
  std::uint64_t triangles = 0;
  void* stream = nullptr;  // a cudaStream_t of the one part's device; null: our own
  double launch_seconds = 0.5;
};

struct LaunchRecord {
  std::uint64_t chunks = 0;
  double longest = 0;  // seconds that the kernels of a chunk took
};

// A device with the memory for its part of queries. One thread at a time.
class QueryDevice {
 public:
  virtual ~QueryDevice() = default;
  // Works until there is no range left: those of parts in its own memory, or else of those in the host's.
  // Throws: DeviceFailure.
  virtual LaunchRecord run(const DeviceQuestion& question, QueryWork& work) = 0;
  int number = 0;
  std::string name;  // "NVIDIA H200"
};

// How many there are; 0 with the reason in `why_not` ("no device", "built without CUDA").
int count_query_devices(std::string& why_not);

// Throws: DeviceFailure.
std::unique_ptr<QueryDevice> open_query_device(int number);

}  // namespace graze::cuda
