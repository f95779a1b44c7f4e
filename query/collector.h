// SPDX-License-Identifier: Apache-2.0
// Hands out the ranges of a query and combines their results in the order of the triangles. The answer does not depend
// on which thread, processor or device finds a result.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <vector>

#include "cuda/query/device_query.h"

namespace graze::query {

struct Outputs {
  unsigned char *bytes = nullptr, *bits = nullptr;
  std::uint64_t* list = nullptr;
  std::uint64_t room = 0;
};

// Called with the number of triangles that are done.   Returns: whether to continue.
using Progress = std::function<bool(std::uint64_t done)>;

class Collector final : public cuda::QueryWork {
 public:
  // Requires: no outputs if `any` is true, because the search then stops at a hit.
  Collector(std::vector<std::uint64_t> counts, std::vector<int> places, std::size_t references, bool any,
            const Outputs& outputs, Progress progress);

  bool next(int device, std::uint64_t most, cuda::QueryRange& range) override;
  void take(const cuda::QueryRange& range, const std::uint64_t* hits, const std::uint64_t* declined,
            std::size_t words) override;
  void take(const cuda::QueryRange& range, std::span<const cuda::QueryCounts> counts) override;
  bool wants_bits() const override { return outputs_.bytes || outputs_.bits || outputs_.list; }
  void stop() override;

  struct Found {
    std::uint64_t position = 0, hits = 0, declined = 0, first = ~std::uint64_t{0}, reference = 0;
    bool cancelled = false;
  };
  Found found() const;

 private:
  struct Part {
    std::uint64_t first, count, next;
    int place;
  };
  struct Chunk {
    std::uint64_t count, hits, declined, first, reference;
    void add(const cuda::QueryCounts& row, std::size_t r);
  };
  void add(const cuda::QueryRange& range, const Chunk& chunk);
  void commit(std::uint64_t first, const Chunk& chunk);
  void put(const cuda::QueryRange& range, const std::uint64_t* hits, const std::uint64_t* declined, std::size_t words);
  void list(const cuda::QueryRange& range, const std::uint64_t* hits, std::size_t words);

  std::vector<Part> parts_;
  std::size_t references_;
  bool any_;
  Outputs outputs_;
  Progress progress_;
  std::uint64_t triangles_ = 0;

  mutable std::mutex mutex_;
  std::condition_variable in_order_;
  std::map<std::uint64_t, Chunk> ahead_;  // by first triangle: chunks that finished before an earlier one
  Found found_;
  bool stopped_ = false;
  std::uint64_t listed_ = 0;
  double said_ = 0;  // when progress was last reported, in seconds
};

}  // namespace graze::query
