// SPDX-License-Identifier: Apache-2.0
#include "query/collector.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <utility>

namespace graze::query {
namespace {

constexpr std::uint64_t kNone = ~std::uint64_t{0};

std::size_t words_of(std::uint64_t count) { return static_cast<std::size_t>((count + 63) / 64); }

std::uint64_t ones(const std::uint64_t* bits, std::uint64_t count) {
  std::uint64_t sum = 0;
  for (std::size_t w = 0; w < count / 64; ++w) sum += static_cast<std::uint64_t>(std::popcount(bits[w]));
  if (count % 64 != 0)
    sum += static_cast<std::uint64_t>(std::popcount(bits[count / 64] & ((std::uint64_t{1} << count % 64) - 1)));
  return sum;
}

std::uint64_t first_of(const std::uint64_t* bits, std::uint64_t count) {
  for (std::size_t w = 0; w < words_of(count); ++w) {
    if (bits[w] != 0) return w * 64 + static_cast<std::uint64_t>(std::countr_zero(bits[w]));
  }
  return kNone;
}

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

Collector::Collector(std::vector<std::uint64_t> counts, std::vector<int> places, std::size_t references, bool any,
                     const Outputs& outputs, Progress progress)
    : references_(references), any_(any), outputs_(outputs), progress_(std::move(progress)) {
  for (std::size_t p = 0; p < counts.size(); ++p) {
    parts_.push_back({triangles_, counts[p], 0, places[p]});
    triangles_ += counts[p];
  }
}

bool Collector::next(int device, std::uint64_t most, cuda::QueryRange& range) {
  const std::lock_guard lock(mutex_);
  if (stopped_) return false;
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    Part& part = parts_[p];
    if (part.place != device || part.next == part.count) continue;
    range = {part.first + part.next, std::min(most, part.count - part.next), p, part.next};
    part.next += range.count;
    return true;
  }
  return false;
}

void Collector::stop() {
  const std::lock_guard lock(mutex_);
  stopped_ = true;
  in_order_.notify_all();
}

void Collector::take(const cuda::QueryRange& range, const std::uint64_t* hits, const std::uint64_t* declined,
                     std::size_t words) {
  put(range, hits, declined, words);
  Chunk chunk{range.count, 0, 0, kNone, 0};
  for (std::size_t r = 0; r < references_; ++r)
    chunk.add({ones(hits + r * words, range.count), 0, first_of(hits + r * words, range.count)}, r);
  for (std::size_t r = 0; r < (any_ ? 1 : references_); ++r)
    chunk.declined += ones(declined + r * words, any_ ? std::min(range.count, chunk.first) : range.count);
  if (outputs_.list) {  // the list grows in the order of the triangles
    std::unique_lock lock(mutex_);
    in_order_.wait(lock, [&] { return stopped_ || found_.position == range.first; });
    if (found_.position != range.first) return;
    lock.unlock();
    list(range, hits, words);
  }
  add(range, chunk);
}

void Collector::take(const cuda::QueryRange& range, std::span<const cuda::QueryCounts> rows) {
  Chunk chunk{range.count, 0, 0, kNone, 0};
  for (std::size_t r = 0; r < rows.size(); ++r) chunk.add(rows[r], r);
  chunk.declined = any_ ? rows[0].declined : chunk.declined;
  add(range, chunk);
}

void Collector::Chunk::add(const cuda::QueryCounts& row, std::size_t r) {
  hits += row.hits;
  declined += row.declined;
  if (row.first < first) first = row.first, reference = r;
}

void Collector::add(const cuda::QueryRange& range, const Chunk& chunk) {
  const std::lock_guard lock(mutex_);
  Chunk numbered = chunk;
  if (chunk.first != kNone) numbered.first += range.first;
  if (any_ && chunk.hits != 0) stopped_ = true;
  if (range.first == found_.position) {
    commit(range.first, numbered);
    for (auto at = ahead_.begin(); at != ahead_.end() && at->first == found_.position; at = ahead_.erase(at))
      commit(at->first, at->second);
  } else {
    ahead_.emplace(range.first, numbered);
  }
  in_order_.notify_all();
  const bool complete = found_.position == triangles_;
  if (!progress_ || (now() - said_ < 0.05 && !complete)) return;
  said_ = now();
  if (!progress_(found_.position) && !complete) found_.cancelled = stopped_ = true;
}

void Collector::commit(std::uint64_t first, const Chunk& chunk) {
  if (any_ && found_.hits != 0) return;
  found_.position = first + chunk.count;
  found_.declined += chunk.declined;
  found_.hits += chunk.hits;
  if (found_.first == kNone && chunk.first != kNone) {
    found_.first = chunk.first;
    found_.reference = chunk.reference;
    if (any_) found_.hits = 1, found_.position = chunk.first + 1;
  }
}

Collector::Found Collector::found() const {
  const std::lock_guard lock(mutex_);
  Found result = found_;
  if (!any_ || found_.hits != 0) return result;
  for (const auto& [first, chunk] : ahead_) {
    if (chunk.hits == 0) continue;
    result.hits = 1;
    result.first = chunk.first;
    result.reference = chunk.reference;
    break;
  }
  return result;
}

void Collector::put(const cuda::QueryRange& range, const std::uint64_t* hits, const std::uint64_t* declined,
                    std::size_t words) {
  for (std::size_t r = 0; r < references_; ++r) {
    const std::uint64_t *yes = hits + r * words, *no_answer = declined + r * words;
    if (outputs_.bytes) {
      unsigned char* bytes = outputs_.bytes + r * triangles_ + range.first;
      for (std::uint64_t i = 0; i < range.count; ++i)
        bytes[i] = static_cast<unsigned char>((yes[i / 64] >> i % 64 & 1) | (no_answer[i / 64] >> i % 64 & 1) << 1);
    }
    if (outputs_.bits) {
      unsigned char* bits = outputs_.bits + r * ((triangles_ + 7) / 8) + range.first / 8;
      for (std::uint64_t i = 0; i < (range.count + 7) / 8; ++i)
        bits[i] = static_cast<unsigned char>(yes[i / 8] >> i % 8 * 8);
    }
  }
}

void Collector::list(const cuda::QueryRange& range, const std::uint64_t* hits, std::size_t words) {
  for (std::size_t w = 0; w < words_of(range.count) && listed_ < outputs_.room; ++w) {
    std::uint64_t some = 0;
    for (std::size_t r = 0; r < references_; ++r) some |= hits[r * words + w];
    for (; some != 0; some &= some - 1) {
      const int bit = std::countr_zero(some);
      const std::uint64_t triangle = range.first + w * 64 + static_cast<std::uint64_t>(bit);
      for (std::size_t r = 0; r < references_; ++r) {
        if ((hits[r * words + w] >> bit & 1) != 0 && listed_ < outputs_.room)
          outputs_.list[listed_++] = triangle * references_ + r;
      }
    }
  }
}

}  // namespace graze::query
