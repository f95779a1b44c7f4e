// SPDX-License-Identifier: Apache-2.0
#include "cli/mesh_pairs.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <memory>
#include <mutex>
#include <numeric>
#include <stdexcept>

#include "analysis/over_threads.h"
#include "core/exact_blocks/decide.h"
#include "core/lanes/lanes.h"
#include "core/relation_of.h"
#include "core/stop.h"
#include "cuda/lanes/device.h"

namespace graze::cli {
namespace {

constexpr std::size_t kBlock = 1 << 10, kDeviceBlock = 1 << 17;  // candidates decided together

// Returns the number of distinct points that are vertices of both triangles.
template <class Real>
int common_vertices(const BasicPair<Real>& pair) {
  int common = 0;
  for (int i = 0; i < 3; ++i) {
    const auto is_p = [&p = pair.a[i]](const Vec3<Real>& q) { return p.x == q.x && p.y == q.y && p.z == q.z; };
    common += std::any_of(pair.b, pair.b + 3, is_p) && std::none_of(pair.a, pair.a + i, is_p);
  }
  return common;
}

template <class Real>
Kind kind_of(const BasicPair<Real>& pair, const Relation& relation) {
  if (!relation.intersects()) return Kind::apart;
  const int common = common_vertices(pair);
  if (common == 1 && relation.contact == Contact::point) return Kind::common_vertex;
  if (common == 2 && relation.contact == Contact::segment) return Kind::common_edge;
  return relation.touches() && relation.contact != Contact::area ? Kind::touches : Kind::pierces;
}

// Counts pairs and keeps the first ones. Thread-safe. Memory: at most twice as many pairs as it keeps.
class Collected {
 public:
  explicit Collected(const Kept& kept) : kept_(kept) {}

  void add(std::span<const FoundPair> pairs, std::size_t candidates) {
    const std::lock_guard lock(mutex_);
    found_.candidates += candidates;
    for (const FoundPair& pair : pairs) {
      ++found_.count[static_cast<std::size_t>(pair.kind)];
      if (!kept_.only_piercing || pair.kind == Kind::pierces) found_.pairs.push_back(pair);
      if (found_.pairs.size() >= 2 * kept_.most) shorten();
    }
  }

  FoundPairs found() {
    if (found_.pairs.size() > kept_.most) shorten();
    std::sort(found_.pairs.begin(), found_.pairs.end());
    return std::move(found_);
  }

 private:
  void shorten() {
    const auto end = found_.pairs.begin() + static_cast<std::ptrdiff_t>(kept_.most);
    std::nth_element(found_.pairs.begin(), end - 1, found_.pairs.end());
    found_.pairs.erase(end, found_.pairs.end());
  }

  Kept kept_;
  std::mutex mutex_;
  FoundPairs found_;
};

// A thread's block of candidates.
struct Block {
  Candidates candidates;
  std::vector<FoundPair> found;

  void decide(const Decider& decider, Collected& collected) {
    if (stop_requested) throw Stopped();
    if (candidates.indices.empty()) return;
    candidates.intersect.assign((candidates.indices.size() + 63) / 64, 0);
    decider.decide(candidates);
    for (std::size_t k = 0; k < candidates.indices.size(); ++k) {
      const auto [i, j] = candidates.indices[k];
      if (!test_bit(candidates.intersect, k)) continue;
      found.push_back(candidates.pairs.empty() ? related(i, j, candidates.pairs_of_doubles[k])
                                               : related(i, j, candidates.pairs[k]));
    }
    collected.add(found, candidates.indices.size());
    candidates.indices.clear();
    candidates.pairs.clear();
    candidates.pairs_of_doubles.clear();
    found.clear();
  }
};

void decide_on_cores(Candidates& of) {
  std::vector<std::uint64_t> declined(of.intersect.size());
  const auto decide = [&](const auto& pairs) {
    exact::decide(coordinates(pairs[0]), pairs.size(), of.intersect.data(), declined.data());
  };
  of.pairs.empty() ? decide(of.pairs_of_doubles) : decide(of.pairs);
}

}  // namespace

std::string_view name(Kind kind) {
  constexpr std::string_view kNames[kKinds] = {"apart", "common_vertex", "common_edge", "touches", "pierces"};
  return kNames[static_cast<std::size_t>(kind)];
}

FoundPair related(std::uint32_t i, std::uint32_t j, const Pair& pair) {
  const Relation relation = relation_of(pair);
  return {i, j, relation.contact, kind_of(pair, relation)};
}

FoundPair related(std::uint32_t i, std::uint32_t j, const DoublePair& pair) {
  const Relation relation = relation_of(pair);
  return {i, j, relation.contact, kind_of(pair, relation)};
}

Pair TwoMeshes::pair(std::uint32_t i, std::uint32_t j) const {
  const auto &p = a.triangles[i], &q = (b ? *b : a).triangles[j];
  return {{p[0], p[1], p[2]}, {q[0], q[1], q[2]}};
}

DoublePair TwoMeshes::pair_of_doubles(std::uint32_t i, std::uint32_t j) const {
  const strata::MeshPairs& other = b ? *b : a;
  DoublePair result = in_doubles(pair(i, j));
  if (!a.in_doubles.empty()) std::copy_n(a.in_doubles[i].begin(), 3, result.a);
  if (!other.in_doubles.empty()) std::copy_n(other.in_doubles[j].begin(), 3, result.b);
  return result;
}

std::string csv_of(std::span<const FoundPair> pairs) {
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text), "i,j,contact,kind\n");
  for (const FoundPair& pair : pairs)
    fmt::format_to(std::back_inserter(text), "{},{},{},{}\n", pair.i, pair.j, name(pair.contact), name(pair.kind));
  return fmt::to_string(text);
}

Decider exact_decider(const std::string& executor) {
  const int cores = tbb::info::default_concurrency();
  if (executor == "one-core") return {executor, 1, kBlock, decide_on_cores};
  if (executor != "one-gpu") return {"all-cores", cores, kBlock, decide_on_cores};
  struct Shared {
    std::mutex turn;
    std::unique_ptr<cuda::Device> device;
    std::vector<VerdictBits> bits;
  };
  const auto shared = std::make_shared<Shared>();
  std::string why_not;
  shared->device = cuda::open_device(why_not);
  if (!shared->device) throw std::runtime_error("--executor one-gpu: there is no CUDA device: " + why_not);
  return {executor, cores, kDeviceBlock, [shared, lane = find_lane("exact/f64/cuda")](Candidates& of) {
            const std::lock_guard lock(shared->turn);
            shared->device->decide(of.pairs, std::span(&lane, 1), shared->bits, of.pairs_of_doubles);
            std::copy_n(shared->bits[0].intersects.begin(), of.intersect.size(), of.intersect.begin());
          }};
}

std::uint64_t FoundPairs::all() const { return std::accumulate(count.begin(), count.end(), std::uint64_t{0}); }

FoundPairs find_pairs(const TwoMeshes& meshes, const Decider& decider, const Kept& kept,
                      const std::function<void(std::size_t)>& told) {
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t processor_start = std::clock();
  const strata::BoxSlabs slabs(
      meshes.a.triangles, meshes.b ? std::optional<strata::BoxSlabs::Triangles>(meshes.b->triangles) : std::nullopt);
  const bool are_doubles = meshes.are_doubles();
  Collected collected(kept);
  tbb::enumerable_thread_specific<Block> blocks;
  std::mutex telling;
  std::size_t done = 0;
  const tbb::global_control limit = analysis::thread_limit(decider.threads);
  tbb::parallel_for(std::size_t{0}, slabs.size(), [&](std::size_t slab) {
    Block& block = blocks.local();
    Candidates& candidates = block.candidates;
    slabs.pairs(slab, [&](std::uint32_t i, std::uint32_t j) {
      candidates.indices.emplace_back(i, j);
      if (are_doubles) {
        candidates.pairs_of_doubles.push_back(meshes.pair_of_doubles(i, j));
      } else {
        candidates.pairs.push_back(meshes.pair(i, j));
      }
      if (candidates.indices.size() == decider.block) block.decide(decider, collected);
    });
    if (stop_requested) throw Stopped();
    const std::lock_guard lock(telling);
    told(done += slabs.triangles_before(slab + 1) - slabs.triangles_before(slab));
  });
  for (Block& block : blocks) block.decide(decider, collected);
  FoundPairs found = collected.found();
  found.declined = slabs.not_finite();
  found.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  found.processor_seconds = static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC;
  return found;
}

}  // namespace graze::cli
