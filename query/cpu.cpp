// SPDX-License-Identifier: Apache-2.0
// Blocks of 64 triangles: turned into columns, looked past by the slabs of each reference four at a time, and what is
// left open decided one by one. Other lanes get pairs.
#include "query/cpu.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "core/exact/exact.h"
#include "core/exact/reference.h"
#include "core/pair.h"
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace graze::query {
namespace {

constexpr std::size_t kBlock = 64;
constexpr std::uint64_t kFirstOfAny = 64, kMostOfRange = 1 << 15, kAlone = 1 << 13;

using Four = float __attribute__((vector_size(16)));
using FourBits = std::int32_t __attribute__((vector_size(16)));

Four lesser(Four x, Four y) { return x < y ? x : y; }
Four greater(Four x, Four y) { return x < y ? y : x; }

unsigned mask_of(FourBits bits) {
#if defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_ps(std::bit_cast<__m128>(bits)));
#else
  return (bits[0] & 1) | (bits[1] & 2) | (bits[2] & 4) | (bits[3] & 8);
#endif
}

// Up to 64 triangles: as rows where the array has them so, and as columns.
struct Block {
  alignas(16) float columns[9][kBlock];
  float copy[kBlock][9];
  const float* rows[kBlock];
  alignas(16) float most[kBlock];
  std::uint64_t not_finite = 0;

  void read(const cuda::TriangleArray& array, std::uint64_t first, std::size_t count) {
    for (std::size_t i = 0; i < kBlock; ++i) {
      const std::uint64_t place = first + std::min(i, count - 1);
      if (array.layout == cuda::Layout::rows) {
        rows[i] = reinterpret_cast<const float*>(array.rows + place * array.stride);
      } else {
        array.load(place, copy[i]);
        rows[i] = copy[i];
      }
      for (std::size_t k = 0; k < 9; ++k) columns[k][i] = rows[i][k];
    }
    not_finite = 0;
    const Four zero = {};
    for (std::size_t i = 0; i < kBlock; i += 4) {
      Four all = column(0, i) * 0.0f, size = greater(column(0, i), -column(0, i));
      for (std::size_t k = 1; k < 9; ++k) {
        all += column(k, i) * 0.0f;  // not a number, from the first that is not finite on
        size = greater(size, greater(column(k, i), -column(k, i)));
      }
      std::memcpy(most + i, &size, sizeof size);
      not_finite |= std::uint64_t{mask_of(all != zero)} << i;
    }
  }

  Four column(std::size_t k, std::size_t i) const {
    Four four;
    std::memcpy(&four, columns[k] + i, sizeof four);
    return four;
  }

  // Which triangles lie beyond a slab; see exact::look_past.   Requires: nothing of those that are not finite.
  std::uint64_t beyond(const exact::Reference& reference) const {
    std::uint64_t result = 0;
    for (std::size_t i = 0; i < kBlock; i += 4) {
      FourBits bits = {};
      Four size;
      std::memcpy(&size, most + i, sizeof size);
      for (const exact::Slab& s : reference.slabs) {
        const Four a = s.x * column(0, i) + s.y * column(1, i) + s.z * column(2, i),
                   b = s.x * column(3, i) + s.y * column(4, i) + s.z * column(5, i),
                   c = s.x * column(6, i) + s.y * column(7, i) + s.z * column(8, i);
        bits |=
            (lesser(lesser(a, b), c) > s.high + s.error * size) | (greater(greater(a, b), c) < s.low - s.error * size);
      }
      result |= std::uint64_t{mask_of(bits)} << i;
    }
    return result;
  }
};

class Worker {
 public:
  explicit Worker(const CpuQuestion& question) : question_(question), pairs_(question.lane->exact ? 0 : kBlock) {
    for (std::size_t r = 0; r < question.references.size() / 9; ++r) {
      const float* reference = question.references.data() + 9 * r;
      finite_.push_back(std::all_of(reference, reference + 9, [](float x) { return std::isfinite(x); }));
      references_.push_back(exact::prepare(finite_.back() ? reference : kOrigin));
    }
  }

  // Decides the range and hands it in.
  void operator()(const cuda::QueryRange& range, cuda::QueryWork& work) {
    const std::size_t words = (range.count + kBlock - 1) / kBlock;
    hits_.resize(words * references_.size());
    declined_.resize(words * references_.size());
    for (std::size_t w = 0; w < words; ++w) {
      const std::size_t count = std::min<std::uint64_t>(kBlock, range.count - w * kBlock);
      block_.read(question_.parts[range.part], range.first_in_part + w * kBlock, count);
      for (std::size_t r = 0; r < references_.size(); ++r) {
        const std::uint64_t all = ~std::uint64_t{0} >> (kBlock - count);
        std::uint64_t &hits = hits_[r * words + w], &declined = declined_[r * words + w];
        hits = declined = 0;
        if (finite_[r]) decide(r, all & ~block_.not_finite, hits, declined);
        declined |= finite_[r] ? all & block_.not_finite : all;
      }
    }
    work.take(range, hits_.data(), declined_.data(), words);
  }

 private:
  static constexpr float kOrigin[9] = {};

  // Of the wanted triangles.
  void decide(std::size_t r, std::uint64_t wanted, std::uint64_t& hits, std::uint64_t& declined) {
    const exact::Reference& reference = references_[r];
    if (question_.lane->exact) {
      for (std::uint64_t left = wanted & ~block_.beyond(reference); left != 0; left &= left - 1) {
        const int i = std::countr_zero(left);
        if (exact::intersects(reference.v, block_.rows[i])) hits |= left & -left;
      }
      return;
    }
    for (std::size_t i = 0; i < kBlock; ++i) {
      std::memcpy(coordinates(pairs_[i]), reference.v, sizeof reference.v);
      std::memcpy(coordinates(pairs_[i]) + 9, block_.rows[i], sizeof reference.v);
    }
    question_.lane->decide(pairs_.data(), kBlock, &hits, &declined);
    declined &= wanted;
    hits &= wanted & ~declined;
  }

  const CpuQuestion& question_;
  std::vector<exact::Reference> references_;
  std::vector<char> finite_;
  Block block_;
  std::vector<Pair> pairs_;
  std::vector<std::uint64_t> hits_, declined_;
};

}  // namespace

void run_on_cpu(const CpuQuestion& question, int threads, cuda::QueryWork& work) {
  const std::uint64_t most =
      std::max<std::uint64_t>(kBlock, kMostOfRange / (question.references.size() / 9) / kBlock * kBlock);
  Worker here(question);
  cuda::QueryRange range;
  std::uint64_t done = 0, wanted = question.any ? std::min(kFirstOfAny, most) : std::min(kAlone, most);
  for (; threads == 1 || done < kAlone; wanted = std::min(most, wanted * 2)) {
    if (!work.next(-1, wanted, range)) return;
    here(range, work);
    done += range.count;
  }
  const auto run = [&](Worker& worker) {
    for (cuda::QueryRange next; work.next(-1, most, next);) worker(next, work);
  };
  const auto start = [&] {
    Worker worker(question);
    run(worker);
  };
  // One task for each thread; those that find no thread free find no range left, later.
  tbb::task_arena arena(threads);
  arena.execute([&] {
    tbb::parallel_for(
        0, threads,
        [&](int t) {
          try {
            t == 0 ? run(here) : start();
          } catch (...) {
            work.stop();
            throw;
          }
        },
        tbb::simple_partitioner());
  });
}

}  // namespace graze::query
