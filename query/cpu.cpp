// SPDX-License-Identifier: Apache-2.0
// Processes blocks of 64 triangles. A block is transposed into columns of floats, and each reference's slabs test four
// triangles at a time. Undecided pairs are collected and decided in batches. Lanes other than exact decide every pair.
// Triangles of doubles are rounded only for the slab test, relative to the reference's first vertex: a difference of
// doubles has a small relative error wherever the triangles are.
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/exact/exact.h"
#include "core/exact/prepared_triangle.h"
#include "core/exact_blocks/decide.h"
#include "core/pair.h"
#include "query/question.h"
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace graze::query {
namespace {

constexpr std::size_t kBlock = 64, kTogether = 256;
constexpr std::uint64_t kFirstOfAny = 64, kMostOfRange = 1 << 15, kAlone = 1 << 13;

using Four = float __attribute__((vector_size(16)));
using FourBits = std::int32_t __attribute__((vector_size(16)));

Four lesser(Four x, Four y) { return x < y ? x : y; }

unsigned mask_of(FourBits bits) {
#if defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_ps(std::bit_cast<__m128>(bits)));
#else
  return (bits[0] & 1) | (bits[1] & 2) | (bits[2] & 4) | (bits[3] & 8);
#endif
}

Four magnitude(Four x) { return std::bit_cast<Four>(std::bit_cast<FourBits>(x) & 0x7fffffff); }

Four load(const float* at) {
  Four four;
  std::memcpy(&four, at, sizeof four);
  return four;
}

void store(float* at, Four four) { std::memcpy(at, &four, sizeof four); }

template <class Real>
bool is_finite(const Real* triangle) {
  return std::all_of(triangle, triangle + 9, [](Real x) { return std::isfinite(x); });
}

// Up to 64 triangles, as rows and as columns. Rows point into the array if its layout is rows. Columns of doubles are
// valid once look_from has filled them.
template <class Real>
struct Block {
  alignas(16) float columns[9][kBlock];
  Real copy[kBlock][9];
  const Real* rows[kBlock];

  void read(const cuda::TriangleArray& array, std::uint64_t first, std::size_t count) {
    for (std::size_t i = 0; i < kBlock; ++i) {
      const std::uint64_t place = first + std::min(i, count - 1);
      if (array.layout == cuda::Layout::rows) {
        rows[i] = reinterpret_cast<const Real*>(array.rows + place * array.stride);
      } else {
        array.load(place, copy[i]);
        rows[i] = copy[i];
      }
    }
    if constexpr (std::is_same_v<Real, float>) {
      for (std::size_t i = 0; i < kBlock; i += 4) {
        transpose(i, 0);
        transpose(i, 4);
        for (std::size_t j = i; j < i + 4; ++j) columns[8][j] = rows[j][8];
      }
    }
  }

  // Sets the columns to differences from the origin; those beyond float32's range become infinite.
  void look_from(const double* origin) {
    for (std::size_t k = 0; k < 9; ++k) {
      for (std::size_t i = 0; i < kBlock; ++i) columns[k][i] = static_cast<float>(rows[i][k] - origin[k % 3]);
    }
  }

  // Transposes rows i to i + 3, coordinates k to k + 3.
  void transpose(std::size_t i, std::size_t k) {
    const Four a = load(rows[i] + k), b = load(rows[i + 1] + k), c = load(rows[i + 2] + k), d = load(rows[i + 3] + k);
    const Four ab = __builtin_shufflevector(a, b, 0, 4, 1, 5), cd = __builtin_shufflevector(c, d, 0, 4, 1, 5),
               more_ab = __builtin_shufflevector(a, b, 2, 6, 3, 7), more_cd = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    store(columns[k] + i, __builtin_shufflevector(ab, cd, 0, 1, 4, 5));
    store(columns[k + 1] + i, __builtin_shufflevector(ab, cd, 2, 3, 6, 7));
    store(columns[k + 2] + i, __builtin_shufflevector(more_ab, more_cd, 0, 1, 4, 5));
    store(columns[k + 3] + i, __builtin_shufflevector(more_ab, more_cd, 2, 3, 6, 7));
  }

  std::uint64_t not_finite() const {
    std::uint64_t result = 0;
    if constexpr (std::is_same_v<Real, double>) {
      for (std::size_t i = 0; i < kBlock; ++i) result |= std::uint64_t{!is_finite(rows[i])} << i;
      return result;
    }
    for (std::size_t i = 0; i < kBlock; i += 4) {
      Four all = {};  // becomes NaN at the first coordinate that is not finite
      for (std::size_t k = 0; k < 9; ++k) all += load(columns[k] + i) * 0.0f;
      result |= std::uint64_t{mask_of(all != all)} << i;
    }
    return result;
  }

  struct Sights {
    std::uint64_t beyond = 0, large = 0;  // large: the sum of the magnitudes is not finite
  };

  // Computes exact::is_beyond for four triangles at a time.
  Sights look_past(const exact::PreparedTriangle& reference) const {
    Sights sights;
    for (std::size_t i = 0; i < kBlock; i += 4) {
      Four v[9];
      for (std::size_t k = 0; k < 9; ++k) v[k] = load(columns[k] + i);
      Four size = magnitude(v[0]);
      for (std::size_t k = 1; k < 9; ++k) size += magnitude(v[k]);
      FourBits beyond = {};
      for (const exact::Slab& s : reference.slabs) {
        const Four a = s.x * v[0] + s.y * v[1] + s.z * v[2] - s.middle,
                   b = s.x * v[3] + s.y * v[4] + s.z * v[5] - s.middle,
                   c = s.x * v[6] + s.y * v[7] + s.z * v[8] - s.middle;
        const FourBits of_a = std::bit_cast<FourBits>(a),
                       signs = (of_a ^ std::bit_cast<FourBits>(b)) | (of_a ^ std::bit_cast<FourBits>(c));
        beyond |= (lesser(lesser(magnitude(a), magnitude(b)), magnitude(c)) > s.half + s.error * size) & (signs >= 0);
      }
      sights.beyond |= std::uint64_t{mask_of(beyond)} << i;
      sights.large |= std::uint64_t{mask_of(~(size <= 0x1.fffffep+127f))} << i;
    }
    return sights;
  }
};

template <class Real>
class Worker {
 public:
  explicit Worker(const Question& question) : question_(question), pairs_(question.lane.exact ? kTogether : kBlock) {
    open_.reserve(kTogether);
    for (std::uint64_t r = 0; r < question.reference_count; ++r) {
      finite_.push_back(is_finite(at(r)));
      references_.push_back(exact::prepare(at(r)));
    }
  }

  // Decides the range and passes the result to `work`.
  void operator()(const cuda::QueryRange& range, cuda::QueryWork& work) {
    const std::size_t words = (range.count + kBlock - 1) / kBlock;
    hits_.resize(words * references_.size());
    declined_.resize(words * references_.size());
    for (std::size_t w = 0; w < words; ++w) {
      const std::size_t count = std::min<std::uint64_t>(kBlock, range.count - w * kBlock);
      block_.read(question_.parts[range.part], range.first_in_part + w * kBlock, count);
      const std::uint64_t all = ~std::uint64_t{0} >> (kBlock - count);
      for (std::size_t r = 0; r < references_.size(); ++r) {
        std::uint64_t &hits = hits_[r * words + w], &declined = declined_[r * words + w];
        hits = 0;
        declined = all;
        if (!finite_[r]) continue;
        if (question_.lane.exact) {
          if constexpr (std::is_same_v<Real, double>) block_.look_from(at(r));
          const typename Block<Real>::Sights sights = block_.look_past(references_[r]);
          declined = all & sights.large ? all & block_.not_finite() : 0;
          gather(r, all & ~(declined | sights.beyond), hits);
        } else {
          const std::uint64_t not_finite = all & block_.not_finite();
          decide(r, all & ~not_finite, hits, declined);
          declined |= not_finite;
        }
      }
    }
    decide_open();
    work.take(range, hits_.data(), declined_.data(), words);
  }

 private:
  // A reference's coordinates.
  const Real* at(std::size_t r) const { return static_cast<const Real*>(question_.references) + 9 * r; }

  // Queues the pairs that the slabs leave undecided. decide_open later sets the bits of those that intersect.
  void gather(std::size_t r, std::uint64_t open, std::uint64_t& hits) {
    for (std::uint64_t left = open; left != 0; left &= left - 1) {
      Real* pair = coordinates(pairs_[open_.size()]);
      std::copy_n(at(r), 9, pair);
      std::copy_n(block_.rows[std::countr_zero(left)], 9, pair + 9);
      open_.push_back({&hits, left & -left});
      if (open_.size() == kTogether) decide_open();
    }
  }

  void decide_open() {
    std::uint64_t hits[kTogether / 64], declined[kTogether / 64];
    if (!open_.empty()) exact::decide(coordinates(pairs_[0]), open_.size(), hits, declined);
    for (std::size_t i = 0; i < open_.size(); ++i) {
      if (hits[i / 64] >> i % 64 & 1) *open_[i].word |= open_[i].bit;
    }
    open_.clear();
  }

  // Decides the wanted triangles with a lane other than exact.
  void decide(std::size_t r, std::uint64_t wanted, std::uint64_t& hits, std::uint64_t& declined) {
    for (std::size_t i = 0; i < kBlock; ++i) {
      std::copy_n(at(r), 9, coordinates(pairs_[i]));
      std::copy_n(block_.rows[i], 9, coordinates(pairs_[i]) + 9);
    }
    question_.lane.decide(pairs_.data(), kBlock, &hits, &declined);
    declined &= wanted;
    hits &= wanted & ~declined;
  }

  const Question& question_;
  std::vector<exact::PreparedTriangle> references_;  // a reference that is not finite is never used
  std::vector<char> finite_;
  Block<Real> block_;
  std::vector<BasicPair<Real>> pairs_;
  struct Open {
    std::uint64_t *word, bit;  // the pair's bit in hits_
  };
  std::vector<Open> open_;
  std::vector<std::uint64_t> hits_, declined_;
};

template <class Real>
void run(const Question& question, cuda::QueryWork& work) {
  const int threads = question.threads;
  const std::uint64_t most = std::max<std::uint64_t>(kBlock, kMostOfRange / question.reference_count / kBlock * kBlock);
  Worker<Real> here(question);
  cuda::QueryRange range;
  std::uint64_t done = 0, wanted = question.any ? std::min(kFirstOfAny, most) : std::min(kAlone, most);
  for (; threads == 1 || done < kAlone; wanted = std::min(most, wanted * 2)) {
    if (!work.next(-1, wanted, range)) return;
    here(range, work);
    done += range.count;
  }
  const auto go_on = [&](Worker<Real>& worker) {
    for (cuda::QueryRange next; work.next(-1, most, next);) worker(next, work);
  };
  const auto start = [&] {
    Worker<Real> worker(question);
    go_on(worker);
  };
  // One task for each thread. A task that gets no free thread starts later, when no range is left.
  tbb::task_arena arena(threads);
  arena.execute([&] {
    tbb::parallel_for(
        0, threads,
        [&](int t) {
          try {
            t == 0 ? go_on(here) : start();
          } catch (...) {
            work.stop();
            throw;
          }
        },
        tbb::simple_partitioner());
  });
}

}  // namespace

void run_on_cpu(const Question& question, cuda::QueryWork& work) {
  question.in_doubles ? run<double>(question, work) : run<float>(question, work);
}

}  // namespace graze::query
