// SPDX-License-Identifier: Apache-2.0
// Queries on a device. Chunks take turns in two or three slots, each with its own stream, so the host's work on one
// chunk (packing triangles, taking results) overlaps with the copies of another and the kernels of a third. Triangles
// in device memory are read in place; triangles in host memory are copied through pinned memory.
#include "cuda/query/device_query.h"

#include <cuda_runtime.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/exact_kernels.cuh"
#include "cuda/lanes/kernels.cuh"
#include "cuda/query/query_kernels.cuh"

namespace graze::cuda {
namespace {

constexpr std::uint64_t kFirstOfAny = 1 << 12, kFirstOfAll = 1 << 20, kFirstResident = 1 << 25, kGrowth = 8;
constexpr std::uint64_t kMostResident = 1 << 27, kMostStreamed = 1 << 20, kMostOfLane = 1 << 20;

// Sets the verdicts on the triangles marked in `not_finite` to declined.
__global__ void __launch_bounds__(kThreads)
    decline(std::uint32_t words, const std::uint32_t* not_finite, std::uint32_t* hits, std::uint32_t* declined) {
  const std::uint32_t w = blockIdx.x * kThreads + threadIdx.x;
  if (w >= words) return;
  declined[w] |= not_finite[w];
  hits[w] &= ~declined[w];
}

// Counts the bits of the first `words` words and adds the results to `counts`, which the caller initialises.
__global__ void __launch_bounds__(kThreads)
    count_bits(std::uint32_t words, const std::uint32_t* hits, const std::uint32_t* declined, QueryCounts* counts) {
  unsigned found = 0, without = 0, first = 0xffffffffu;
  for (std::uint32_t w = blockIdx.x * kThreads + threadIdx.x; w < words; w += gridDim.x * kThreads) {
    found += static_cast<unsigned>(__popc(hits[w]));
    without += static_cast<unsigned>(__popc(declined[w]));
    if (hits[w]) first = min(first, w * 32 + static_cast<unsigned>(__ffs(static_cast<int>(hits[w]))) - 1);
  }
  for (int far = 16; far > 0; far /= 2) {
    found += __shfl_xor_sync(0xffffffffu, found, far);
    without += __shfl_xor_sync(0xffffffffu, without, far);
    first = min(first, __shfl_xor_sync(0xffffffffu, first, far));
  }
  if (threadIdx.x % 32 != 0) return;
  using Long = unsigned long long;
  if (found) atomicAdd(reinterpret_cast<Long*>(&counts->hits), Long{found});
  if (without) atomicAdd(reinterpret_cast<Long*>(&counts->declined), Long{without});
  if (found) atomicMin(reinterpret_cast<Long*>(&counts->first), Long{first});
}

// Finds the earliest hit in any row, and subtracts the declined triangles after it from the first row's count of
// declined triangles.
__global__ void __launch_bounds__(kThreads)
    forget_behind(std::uint32_t words, const std::uint32_t* declined, QueryCounts* counts, std::uint32_t rows) {
  std::uint64_t first = ~std::uint64_t{0};
  for (std::uint32_t r = 0; r < rows; ++r) first = min(first, counts[r].first);
  const std::uint64_t w = blockIdx.x * kThreads + threadIdx.x;
  if (w >= words || w < first / 32) return;
  const std::uint32_t behind = w > first / 32 ? 0xffffffffu : ~((1u << first % 32) - 1);
  const int forgotten = __popc(declined[w] & behind);
  if (forgotten != 0)
    atomicAdd(reinterpret_cast<unsigned long long*>(&counts->declined), static_cast<unsigned long long>(-forgotten));
}

// Writes a byte for each triangle: 1 for a hit, 2 for declined, else 0.
__global__ void __launch_bounds__(kThreads)
    write_bytes(std::uint32_t count, const std::uint32_t* hits, const std::uint32_t* declined, unsigned char* bytes) {
  const std::uint32_t i = blockIdx.x * kThreads + threadIdx.x;
  if (i >= count) return;
  const std::uint32_t hit = hits[i / 32] >> i % 32 & 1, no_answer = declined[i / 32] >> i % 32 & 1;
  bytes[i] = static_cast<unsigned char>(hit | no_answer << 1);
}

std::uint32_t blocks_for(std::uint32_t things) { return (things + kThreads - 1) / kThreads; }

// The outputs of a chunk's kernels.
struct Verdicts {
  DeviceArray<std::uint32_t> hits, declined, lists, counts, not_finite;
  DeviceArray<float> columns;
  DeviceArray<char> triangles;
  DeviceArray<QueryCounts> found;
  DeviceExact exact;  // for a lane under the policy `filtered`
};

struct Slot {
  Stream stream{cudaStreamNonBlocking};
  Event start, stop, done;
  Verdicts verdicts;
  PinnedArray<char> triangles;
  PinnedArray<std::uint64_t> hits, declined;
  PinnedArray<QueryCounts> found;
  std::optional<QueryRange> range;  // the range in progress, if any
};

// Writes the triangles as rows without gaps to pinned memory, from which devices copy fast.
template <class Real>
void pack(const TriangleArray& array, std::uint64_t first, std::uint64_t count, Real* to) {
  constexpr std::uint64_t kPart = 1 << 14, kEach = 9 * sizeof(Real);
  tbb::parallel_for(std::uint64_t{0}, (count + kPart - 1) / kPart, [&](std::uint64_t part) {
    const std::uint64_t begin = part * kPart, end = std::min(count, begin + kPart);
    if (array.packed(sizeof(Real))) {
      std::memcpy(to + 9 * begin, array.rows + kEach * (first + begin), kEach * (end - begin));
    } else {
      for (std::uint64_t i = begin; i < end; ++i) array.load(first + i, to + 9 * i);
    }
  });
}

bool is_pinned(const void* at) {
  cudaPointerAttributes attributes;
  check(cudaPointerGetAttributes(&attributes, at));
  return attributes.type == cudaMemoryTypeHost;
}

class Run {
 public:
  Run(const DeviceQuestion& question, QueryWork& work, int device, Slot* slots)
      : question_(question), work_(work), device_(device), slots_(slots) {
    for (std::size_t r = 0; r < question.reference_count; ++r)
      references_.push_back(question.in_doubles
                                ? exact::prepare(doubles(r))
                                : exact::prepare(static_cast<const float*>(question.references) + 9 * r));
    resident_ = std::any_of(question.places.begin(), question.places.end(), [&](int p) { return p == device; });
    pinned_ =
        !resident_ && std::all_of(question.parts.begin(), question.parts.end(), [this](const TriangleArray& part) {
          return part.count == 0 || (part.packed(real_) && is_pinned(part.rows));
        });
    most_ = !question.lane.exact ? kMostOfLane : resident_ ? kMostResident : kMostStreamed;
    most_ = std::max<std::uint64_t>(1 << 12, most_ / references_.size() / 64 * 64);
    std::size_t free = 0, all = 0;
    check(cudaMemGetInfo(&free, &all));
    // Bytes per triangle in all slots: lists, verdicts, and the triangles unless they are already in device memory.
    // Chunks use at most half of the free memory.
    const std::size_t bytes =
        (resident_ ? 32 : 3 * (24 + 9 * real_)) + references_.size() + (question.lane.exact ? 0 : 3 * 76);
    while (most_ > 1 << 12 && most_ * bytes > free / 2) most_ /= 2;
    // The first chunks may be large unless the time limit for a launch is very short.
    const bool at_leisure = resident_ && question.lane.exact && question.launch_seconds >= 0.05;
    if (resident_ && !question.stream) wait_for_default_stream();
    chunk_ = std::min(most_, question.any ? kFirstOfAny : at_leisure ? kFirstResident : kFirstOfAll);
  }

  // When a run ends, even by an exception, none of its work may still be running, because the caller frees the memory.
  ~Run() {
    bool busy = false;
    for (int k = 0; k < kSlots; ++k) busy = std::exchange(slots_[k].range, std::nullopt) || busy;
    if (busy || failed_) cudaDeviceSynchronize();
  }

  LaunchRecord operator()() {
    const int slots = resident_ ? 2 : kSlots;
    int k = 0;
    for (;; k = (k + 1) % slots) {
      finish(slots_[k]);
      QueryRange range;
      if (!work_.next(resident_ ? device_ : -1, chunk_, range)) break;
      start(slots_[k], question_.stream && resident_ ? slots_[0] : slots_[k], range);
    }
    for (int left = 1; left < slots; ++left) finish(slots_[(k + left) % slots]);  // the oldest chunk first
    return record_;
  }

  static constexpr int kSlots = 3;

 private:
  // Our streams do not wait for the default stream, on which the caller may just have copied triangles: a cudaMemcpy
  // from pageable memory returns before the data has arrived.
  void wait_for_default_stream() {
    check(cudaEventRecord(slots_[0].start, cudaStreamLegacy));
    for (int k = 0; k < kSlots; ++k) check(cudaStreamWaitEvent(slots_[k].stream, slots_[0].start));
  }

  // On the caller's stream, chunks run one after another, so slots can share the kernels' outputs. On our streams, the
  // last steps of a chunk, which do little work, overlap with the first steps of the next chunk.
  void start(Slot& slot, Slot& shared, const QueryRange& range) {
    failed_ = true;  // until all of the chunk's work has started
    const auto count = static_cast<std::uint32_t>(range.count);
    const cudaStream_t stream =
        resident_ && question_.stream ? static_cast<cudaStream_t>(question_.stream) : cudaStream_t{shared.stream};
    QueryChunk chunk{question_.parts[range.part], range.first_in_part, count};
    Verdicts& at = shared.verdicts;
    if (!resident_) {
      const std::size_t each = 9 * real_;
      const char* from = chunk.array.rows + each * range.first_in_part;
      if (!pinned_) {
        char* packed = slot.triangles.at_least(each * range.count);
        if (question_.in_doubles) {
          pack(chunk.array, range.first_in_part, range.count, reinterpret_cast<double*>(packed));
        } else {
          pack(chunk.array, range.first_in_part, range.count, reinterpret_cast<float*>(packed));
        }
        from = packed;
      }
      char* triangles = at.triangles.at_least(each * range.count);
      check(cudaMemcpyAsync(triangles, from, each * range.count, cudaMemcpyHostToDevice, stream));
      chunk = {{}, 0, count};
      chunk.array.rows = triangles;
      chunk.array.stride = each;
      chunk.array.count = count;
    }
    const std::size_t words = row_words(count), rows = references_.size();
    const std::uint32_t words_in_use = (count + 31) / 32;
    std::uint32_t *hits = at.hits.at_least(words * rows), *declined = at.declined.at_least(words * rows);
    QueryCounts* found = at.found.at_least(rows);
    check(cudaMemsetAsync(found, 0, rows * sizeof *found, stream));
    check(cudaEventRecord(slot.start, stream));
    for (std::size_t r = 0; r < rows; ++r) {
      decide(at, r, chunk, hits + r * words, declined + r * words, stream);
      check(cudaMemsetAsync(&found[r].first, 0xff, sizeof found[r].first, stream));
      count_bits<<<std::min(blocks_for(words_in_use), 512u), kThreads, 0, stream>>>(words_in_use, hits + r * words,
                                                                                    declined + r * words, found + r);
      put(range, r, hits + r * words, declined + r * words, stream);
    }
    if (question_.any)
      forget_behind<<<blocks_for(words_in_use), kThreads, 0, stream>>>(words_in_use, declined, found,
                                                                       static_cast<std::uint32_t>(rows));
    check(cudaGetLastError());
    check(cudaEventRecord(slot.stop, stream));
    if (work_.wants_bits()) {
      fetch(slot.hits, hits, words * rows, stream);
      fetch(slot.declined, declined, words * rows, stream);
    }
    check(cudaMemcpyAsync(slot.found.at_least(rows), found, rows * sizeof *found, cudaMemcpyDeviceToHost, stream));
    check(cudaEventRecord(slot.done, stream));
    slot.range = range;
    failed_ = false;
  }

  static void fetch(PinnedArray<std::uint64_t>& to, const std::uint32_t* from, std::size_t words, cudaStream_t stream) {
    check(cudaMemcpyAsync(to.at_least(words / 2), from, words * sizeof *from, cudaMemcpyDeviceToHost, stream));
  }

  void decide(Verdicts& at, std::size_t r, const QueryChunk& chunk, std::uint32_t* hits, std::uint32_t* declined,
              cudaStream_t stream) {
    const exact::PreparedTriangle& reference = references_[r];
    if (question_.lane.exact) {
      std::uint32_t* lists = at.lists.at_least(2 * std::size_t{chunk.count});
      std::uint32_t* counts = at.counts.at_least(kQueryLists);
      if (question_.in_doubles)
        return launch_exact_query(reference, doubles(r), chunk, lists, counts, hits, declined, stream);
      return launch_exact_query(reference, chunk, lists, counts, hits, declined, stream);
    }
    const std::uint32_t words = row_words(chunk.count);
    float* columns = at.columns.at_least(std::size_t{words} * 32 * kCoordinates);
    std::uint32_t* not_finite = at.not_finite.at_least(words);
    launch_pair_up(reference, chunk, columns, not_finite, stream);
    launch_lane(question_.lane, at.exact, {columns, words * 32, chunk.count}, hits, declined, stream);
    decline<<<blocks_for(words), kThreads, 0, stream>>>(words, not_finite, hits, declined);
  }

  const double* doubles(std::size_t r) const { return static_cast<const double*>(question_.references) + 9 * r; }

  // Writes the outputs that the caller wants in device memory.
  void put(const QueryRange& range, std::size_t r, const std::uint32_t* hits, const std::uint32_t* declined,
           cudaStream_t stream) {
    const auto count = static_cast<std::uint32_t>(range.count);
    if (question_.bytes)
      write_bytes<<<blocks_for(count), kThreads, 0, stream>>>(count, hits, declined,
                                                              question_.bytes + r * question_.triangles + range.first);
    if (question_.bits)
      check(cudaMemcpyAsync(question_.bits + r * ((question_.triangles + 7) / 8) + range.first / 8, hits,
                            (range.count + 7) / 8, cudaMemcpyDeviceToDevice, stream));
  }

  void finish(Slot& slot) {
    if (!slot.range) return;
    const QueryRange range = *std::exchange(slot.range, std::nullopt);
    check(cudaEventSynchronize(slot.done));
    float milliseconds = 0;
    check(cudaEventElapsedTime(&milliseconds, slot.start, slot.stop));
    const double seconds = milliseconds / 1000.0;
    record_.longest = std::max(record_.longest, seconds);
    ++record_.chunks;
    // The next chunk may be larger, as long as it takes less than half of the time limit for a launch.
    const double fitting = static_cast<double>(range.count) * question_.launch_seconds / 2 / std::max(seconds, 1e-9);
    const std::uint64_t wanted = std::min(most_, std::max(chunk_, range.count * kGrowth));
    chunk_ = fitting < static_cast<double>(wanted) ? static_cast<std::uint64_t>(fitting) : wanted;
    chunk_ = std::max<std::uint64_t>(1 << 12, chunk_ / 64 * 64);
    const std::size_t rows = references_.size();
    if (work_.wants_bits()) {
      work_.take(range, slot.hits.at_least(0), slot.declined.at_least(0),
                 row_words(static_cast<std::uint32_t>(range.count)) / 2);
    } else {
      work_.take(range, std::span<const QueryCounts>(slot.found.at_least(rows), rows));
    }
  }

  const DeviceQuestion& question_;
  const std::size_t real_ = question_.in_doubles ? sizeof(double) : sizeof(float);
  QueryWork& work_;
  int device_;
  Slot* slots_;
  std::vector<exact::PreparedTriangle> references_;
  bool resident_ = false, pinned_ = false, failed_ = false;
  std::uint64_t most_ = 0, chunk_ = 0;
  LaunchRecord record_;
};

// Makes a device current; the destructor restores the caller's device.
class Current {
 public:
  explicit Current(int device) {
    check(cudaGetDevice(&before_));
    check(cudaSetDevice(device));
  }
  Current(const Current&) = delete;
  Current& operator=(const Current&) = delete;
  ~Current() {
    cudaGetLastError();  // clears this run's error; otherwise the next check would report it
    cudaSetDevice(before_);
  }

 private:
  int before_ = 0;
};

class CudaQueryDevice final : public QueryDevice {
 public:
  explicit CudaQueryDevice(int wanted) {
    number = wanted;
    const Current current(wanted);
    cudaDeviceProp properties;
    check(cudaGetDeviceProperties(&properties, wanted));
    name = properties.name;
    slots_.reset(new Slot[Run::kSlots]);
  }

  LaunchRecord run(const DeviceQuestion& question, QueryWork& work) override {
    const Current current(number);
    return Run(question, work, number, slots_.get())();
  }

 private:
  std::unique_ptr<Slot[]> slots_;
};

}  // namespace

int count_query_devices(std::string& why_not) {
  const int count = count_devices();
  if (count == 0) why_not = "no device";
  return count;
}

std::unique_ptr<QueryDevice> open_query_device(int number) { return std::make_unique<CudaQueryDevice>(number); }

}  // namespace graze::cuda
