// SPDX-License-Identifier: Apache-2.0
// The functions that the Python package calls through ctypes (python/graze/_library.py). An array of pairs has the
// shape (n, 2, 3, 3), and an array of triangles has the shape (n, 3, 3). Numbers are float32, or doubles if `doubles`
// is set. Functions return 0 for success, 1 for a failure, which graze_py_error describes, or 2 if they were asked to
// stop. No exception leaves this file.
#include <fmt/format.h>
#include <graze/test.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <exception>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "backends/backends.h"
#include "core/lanes/lanes.h"
#include "core/lanes/policies.h"
#include "core/margin/margin.h"
#include "core/relation_of.h"
#include "core/stop.h"
#include "core/text.h"
#include "query/include/graze/query_c.h"
#include "strata/mesh_slabs.h"
#include "strata/pair_source.h"
#include "strata/strata.h"

namespace graze {

struct graze_py_options {
  const char* strata;
  std::uint64_t pairs, seed;
  double max_wrong;
  int touching, coplanar, degenerate, shared;  // 1: both answers are accepted on such pairs
};

struct graze_py_result {
  int passed, has_smallest;
  Pair smallest;
};

namespace {

constexpr std::size_t kBlock = 1024;  // pairs decided together; their verdict bits fill whole words

thread_local std::string error, text;
thread_local std::vector<std::array<std::uint32_t, 2>> found;

template <class F>
int guarded(F f) noexcept {
  try {
    f();
    return 0;
  } catch (const Stopped&) {
    return 2;
  } catch (const std::exception& e) {
    error = e.what();
  } catch (...) {
    error = "an unknown failure";
  }
  return 1;
}

// Calls f(first, count) for blocks of the range, on all cores.
template <class F>
void in_blocks(std::size_t count, F f) {
  tbb::parallel_for(std::size_t{0}, (count + kBlock - 1) / kBlock,
                    [&](std::size_t block) { f(block * kBlock, std::min(kBlock, count - block * kBlock)); });
}

std::int8_t code(Verdict verdict) { return verdict == Verdict::intersects ? 1 : verdict == Verdict::disjoint ? 0 : -1; }

// Returns the function that runs the lane, or the lane's twin, on this processor.   Throws: std::invalid_argument.
DecideBlock decider_of(const std::string& id) {
  const std::optional<LaneName> name = parse_lane_name(id);
  const Lane* lane = find_lane(id);
  std::string policy;
  if (!lane && name && !name->policy.empty()) {
    lane = find_lane(id_of({name->subject, name->scalar, name->variant, ""}));
    policy = name->policy;
  }
  if (!lane || (!policy.empty() && lane->algorithm < 0))
    throw std::invalid_argument(fmt::format("there is no lane {}; graze.lanes() lists them", shown(id)));
  const Lane asked = policy.empty() ? *lane : lane_under(*lane, policy);
  const DecideBlock block = backends::on_host(asked);
  if (!block)
    throw std::invalid_argument(fmt::format("the lane {} does not run here: {}", id, backends::why_not_on_host(asked)));
  return block;
}

// Calls f with the pairs as Pair or DoublePair.
template <class F>
void visit(const void* pairs, int doubles, F f) {
  doubles ? f(static_cast<const DoublePair*>(pairs)) : f(static_cast<const Pair*>(pairs));
}

// Decides up to kBlock pairs. For a lane that takes no doubles, pairs of doubles are first rounded to float32.
template <class Real>
void decide_block(const DecideBlock& decide, const BasicPair<Real>* pairs, std::size_t count, std::uint64_t* intersects,
                  std::uint64_t* declined) {
  if constexpr (std::is_same_v<Real, double>) {
    if (!decide.decides_doubles()) {
      std::vector<Pair> stored(count);
      std::transform(pairs, pairs + count, stored.begin(), stored_in_float32);
      return decide(stored.data(), count, intersects, declined);
    }
  }
  decide(pairs, count, intersects, declined);
}

template <class Real>
using Triangle = std::array<Vec3<Real>, 3>;
template <class Real>
using Triangles = std::span<const Triangle<Real>>;

template <class Real>
Triangles<Real> triangles_of(const void* numbers, std::uint64_t count) {
  static_assert(sizeof(Triangle<Real>) == 9 * sizeof(Real));
  return {static_cast<const Triangle<Real>*>(numbers), count};
}

// Rounds the triangles to float32, to compute their boxes. Rounding preserves the order of coordinates, even
// where it clamps them to the largest float32. So if triangles intersect, their rounded boxes overlap.
std::vector<Triangle<float>> rounded(Triangles<double> triangles) {
  static constexpr double kMost = std::numeric_limits<float>::max();
  const auto round = [](double x) { return static_cast<float>(std::isfinite(x) ? std::clamp(x, -kMost, kMost) : x); };
  std::vector<Triangle<float>> result(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    std::transform(triangles[i].begin(), triangles[i].end(), result[i].begin(), [&](const Vec3<double>& v) {
      return Vec3<float>{round(v.x), round(v.y), round(v.z)};
    });
  }
  return result;
}

// Whether no tiny translation separates the triangles, or they are coplanar and share an area.
bool pierces(const Relation& r) { return r.intersects() && (!r.touches() || r.contact == Contact::area); }

std::vector<std::string> parts_of(std::string_view names) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= names.size();) {
    const std::size_t end = std::min(names.find(',', begin), names.size());
    if (end > begin) parts.emplace_back(names.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

// Finds and sorts the pairs of triangles that intersect, within a mesh or between two. boxes: the triangles' boxes.
template <class Real>
void find_intersections(Triangles<Real> first, Triangles<Real> second, const strata::BoxSlabs& boxes,
                        bool only_piercing, const int& stop) {
  tbb::enumerable_thread_specific<std::vector<std::array<std::uint32_t, 2>>> parts;
  tbb::parallel_for(std::size_t{0}, boxes.size(), [&](std::size_t slab) {
    std::vector<std::array<std::uint32_t, 2>>& part = parts.local();
    boxes.pairs(slab, [&](std::uint32_t i, std::uint32_t j) {
      if (__atomic_load_n(&stop, __ATOMIC_RELAXED)) throw Stopped();
      const Triangle<Real>&of_a = first[i], &of_b = second[j];
      const Relation r = relation_of(BasicPair<Real>{{of_a[0], of_a[1], of_a[2]}, {of_b[0], of_b[1], of_b[2]}});
      if (only_piercing ? pierces(r) : r.intersects()) part.push_back({i, j});
    });
  });
  found.clear();
  for (const auto& part : parts) found.insert(found.end(), part.begin(), part.end());
  std::sort(found.begin(), found.end());
}

TestOptions options_of(const graze_py_options& o) {
  const auto answer = [](int either) { return either ? Answer::either : Answer::required; };
  return {.strata = o.strata,
          .pairs = o.pairs,
          .seed = o.seed,
          .max_wrong = o.max_wrong,
          .touching = answer(o.touching),
          .coplanar = answer(o.coplanar),
          .degenerate = answer(o.degenerate),
          .shared = answer(o.shared)};
}

}  // namespace

extern "C" {

// The message of this thread's last failure.
const char* graze_py_error() { return error.c_str(); }

// The names of all strata, one per line.
const char* graze_py_strata() {
  text.clear();
  for (const auto& stratum : strata::kStrata) text += std::string(stratum.id) + '\n';
  return text.c_str();
}

// The names of all lanes that run on this processor, one per line.
const char* graze_py_lanes() {
  text.clear();
  for (const Lane& lane : lanes()) {
    if (backends::on_host(lane)) text += lane.id + '\n';
  }
  return text.c_str();
}

// Draws the pairs [first, first + count) of `all` pairs of the strata.
int graze_py_pairs(const char* names, std::uint64_t seed, std::uint64_t all, std::uint64_t first, std::uint64_t count,
                   void* pairs, int doubles) {
  return guarded([&] {
    std::uint64_t begin = 0;
    const PairTypes types = doubles ? PairTypes::f64 : PairTypes::f32;
    for (const strata::PairSource& source : strata::stratum_sources(seed, all, parts_of(names), types)) {
      const std::uint64_t from = std::max(first, begin), to = std::min(first + count, begin + source.pairs);
      if (from < to)
        in_blocks(to - from, [&](std::size_t at, std::size_t some) {
          for (std::size_t i = at; i < at + some; ++i) {
            if (doubles) {
              static_cast<DoublePair*>(pairs)[from - first + i] = source.double_pair(from - begin + i);
            } else {
              static_cast<Pair*>(pairs)[from - first + i] = source.pair(from - begin + i);
            }
          }
        });
      begin += source.pairs;
    }
  });
}

// The exact relation of each pair: verdict (1, 0, -1 declined), contact (0 none, 1 point, 2 segment, 3 area, 4
// unknown), sign of the margin, dimension of both hulls, and whether all vertices lie in one plane.
int graze_py_relations(const void* numbers, int doubles, std::uint64_t count, std::int8_t (*relations)[6]) {
  return guarded([&] {
    visit(numbers, doubles, [&](const auto* pairs) {
      in_blocks(count, [&](std::size_t first, std::size_t some) {
        for (std::size_t i = first; i < first + some; ++i) {
          const Relation r = relation_or_declined(pairs[i]);
          const std::int8_t row[6] = {code(r.verdict),
                                      static_cast<std::int8_t>(r.contact),
                                      static_cast<std::int8_t>(r.margin_sign),
                                      static_cast<std::int8_t>(r.hulls.dimension_a),
                                      static_cast<std::int8_t>(r.hulls.dimension_b),
                                      static_cast<std::int8_t>(r.hulls.coplanar)};
          std::memcpy(relations[i], row, sizeof row);
        }
      });
    });
  });
}

// Certified bounds of each margin: least, most. Both are 0 if the margin is exactly 0, and NaN if the pair is not
// finite.
int graze_py_margins(const Pair* pairs, std::uint64_t count, double (*margins)[2]) {
  return guarded([&] {
    in_blocks(count, [&](std::size_t first, std::size_t some) {
      for (std::size_t i = first; i < first + some; ++i) {
        const Relation r = relation_or_declined(pairs[i]);
        double &least = margins[i][0], &most = margins[i][1];
        least = most = r.verdict == Verdict::declined ? std::numeric_limits<double>::quiet_NaN() : 0;
        if (r.verdict == Verdict::declined || r.margin_sign == 0) continue;
        const MarginBounds bounds = margin_bounds(pairs[i], r.verdict);
        least = r.margin_sign > 0 ? bounds.lo : -bounds.hi;
        most = r.margin_sign > 0 ? bounds.hi : -bounds.lo;
      }
    });
  });
}

// The lane's verdict on each pair: 1, 0, or -1 declined.
int graze_py_verdicts(const char* lane, const void* numbers, int doubles, std::uint64_t count, std::int8_t* verdicts) {
  return guarded([&] {
    const DecideBlock decide = decider_of(lane);
    const std::optional<LaneName> name = parse_lane_name(lane);
    if (doubles && name->scalar != "f32" && !decide.decides_doubles())
      throw std::invalid_argument(fmt::format("the lane {} takes only float32; round the pairs yourself", lane));
    visit(numbers, doubles, [&](const auto* pairs) {
      in_blocks(count, [&](std::size_t first, std::size_t some) {
        std::uint64_t intersects[kBlock / 64], declined[kBlock / 64];
        decide_block(decide, pairs + first, some, intersects, declined);
        for (std::size_t i = 0; i < some; ++i)
          verdicts[first + i] = code(verdict_of_bits(intersects[i / 64] >> i % 64 & 1, declined[i / 64] >> i % 64 & 1));
      });
    });
  });
}

// Whether each triangle meets the reference: 1, 0, or -1 declined.
int graze_py_meets(const void* reference, const void* triangles, int doubles, std::uint64_t count,
                   std::int8_t* verdicts) {
  return guarded([&] {
    static graze_context* const context = graze_open();
    graze_triangles part{};
    part.device = -1;
    part.count = count;
    part.rows = triangles;
    graze_query query{};
    query.size = sizeof query;
    query.coordinates = doubles ? GRAZE_F64 : GRAZE_F32;
    query.references = reference;
    query.reference_count = query.part_count = 1;
    query.parts = &part;
    query.mode = GRAZE_ALL;
    query.executor = GRAZE_ALL_CORES;
    query.bytes = reinterpret_cast<unsigned char*>(verdicts);
    graze_answer answer;
    if (graze_run(context, &query, &answer) != GRAZE_OK) throw std::runtime_error(answer.message);
    std::replace(verdicts, verdicts + count, std::int8_t{2}, std::int8_t{-1});
  });
}

// Finds the pairs of triangles that intersect within a mesh (b null) or between two meshes. If only_piercing is set,
// pairs that merely touch are left out. Sets the number of pairs; a call of graze_py_take in the same thread then
// copies the sorted pairs. Ends soon after another thread makes `stop` nonzero.
int graze_py_intersections(const void* a, std::uint64_t count_a, const void* b, std::uint64_t count_b, int doubles,
                           int only_piercing, std::uint64_t* count, const int* stop) {
  return guarded([&] {
    const auto search = [&]<class Real>(Real, const auto& boxes_of) {
      const auto first = triangles_of<Real>(a, count_a), second = b ? triangles_of<Real>(b, count_b) : first;
      const auto boxes = boxes_of(first), others = b ? boxes_of(second) : decltype(boxes_of(second))();
      const strata::BoxSlabs slabs(boxes, b ? std::optional<Triangles<float>>(others) : std::nullopt);
      find_intersections<Real>(first, second, slabs, only_piercing != 0, *stop);
    };
    doubles ? search(double{}, rounded) : search(float{}, [](Triangles<float> t) { return t; });
    *count = found.size();
  });
}

void graze_py_take(std::uint32_t* indices) {
  if (!found.empty()) std::memcpy(indices, found.data(), found.size() * sizeof found[0]);
  found = {};
}

// Decides `count` pairs; verdicts are numbers of the enum Verdict.   Returns: nonzero to end the test.
typedef int (*graze_py_decide)(const Pair* pairs, std::uint64_t count, std::uint8_t* verdicts);

// Tests the function on the strata (graze/test.h). graze_py_text then gives the summary, an empty line and the fault.
int graze_py_test(const char* name, graze_py_decide decide, const graze_py_options* options, graze_py_result* result) {
  static_assert(sizeof(Verdict) == 1);
  return guarded([&] {
    const TestResult r = test_pairs(
        name,
        [&](const Pair* pairs, std::size_t count, Verdict* verdicts) {
          if (decide(pairs, count, reinterpret_cast<std::uint8_t*>(verdicts)) != 0) throw Stopped();
        },
        options_of(*options));
    *result = {r.passed, r.smallest.has_value(), r.smallest.value_or(Pair{})};
    text = r.summary + '\n' + r.fault;
  });
}

// Writes to graze_py_text what is wrong with the verdict on the pair, or nothing if the verdict is accepted.
int graze_py_fault(const Pair* pair, std::uint8_t verdict, const graze_py_options* options) {
  return guarded([&] { text = fault_of(*pair, static_cast<Verdict>(verdict), options_of(*options)); });
}

const char* graze_py_text() { return text.c_str(); }

}  // extern "C"
}  // namespace graze
