// SPDX-License-Identifier: Apache-2.0
#include "query/question.h"

#include <tbb/info.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/text.h"

namespace graze::query {
namespace {

constexpr std::uint64_t kMostTriangles = GRAZE_MOST_TRIANGLES, kMostReferences = 1 << 16, kMostParts = 1 << 16,
                        kMostPairs = std::uint64_t{1} << 62;

// Times in nanoseconds, for GRAZE_AUTO only: one verdict on one core, the transfer of a triangle of floats to a device,
// and the start of CUDA. The first two are measured on an H200 and its host (docs/measurements.md); the third is
// assumed.
constexpr double kOnCore = 11, kToDevice = 0.7, kStart = 3e8;
constexpr std::uint64_t kWorthThreads = 1 << 14;

[[noreturn]] void refuse(const std::string& what) { throw QueryError(GRAZE_BAD_ARGUMENT, what); }

void expect(bool holds, const std::string& what) {
  if (!holds) refuse(what);
}

void expect_aligned(const void* at, const std::string& name, std::size_t alignment = alignof(std::uint32_t)) {
  expect(at != nullptr, name + ": expected a pointer, found NULL");
  expect(reinterpret_cast<std::uintptr_t>(at) % alignment == 0,
         name + ": expected a pointer that is a multiple of " + std::to_string(alignment));
}

// Whether `count` elements of `size` bytes, `stride` bytes apart, fit into an object at this address: within
// PTRDIFF_MAX bytes and before the end of the address space.
bool fits(const void* at, std::uint64_t count, std::size_t stride, std::size_t size) {
  const std::uintptr_t room = std::min<std::uintptr_t>(PTRDIFF_MAX, UINTPTR_MAX - reinterpret_cast<std::uintptr_t>(at));
  return count == 0 || (size <= room && (count - 1) <= (room - size) / stride);
}

void expect_fits(const void* at, std::uint64_t count, std::size_t stride, std::size_t size, const std::string& name) {
  expect(fits(at, count, stride, size), name + ": expected an array that fits into memory, found " +
                                            std::to_string(count) + " elements, one every " + std::to_string(stride) +
                                            " bytes");
}

std::size_t stride_of(std::size_t stride, std::size_t least, std::size_t alignment, const std::string& name) {
  if (stride == 0) return least;
  expect(stride >= least && stride <= PTRDIFF_MAX && stride % alignment == 0,
         name + ": expected a stride of " + std::to_string(least) + " to " + std::to_string(PTRDIFF_MAX) +
             " bytes that is a multiple of " + std::to_string(alignment) + ", found " + std::to_string(stride));
  return stride;
}

// real: the size of a coordinate in bytes.
cuda::TriangleArray array_of(const graze_triangles& part, std::size_t real, const std::string& name) {
  const std::size_t element[] = {9 * real, real, 3 * sizeof(std::uint32_t)};  // bytes, by layout
  expect(part.count <= kMostTriangles, name + ": expected at most 2^48 triangles, found " + std::to_string(part.count));
  expect(part.layout >= GRAZE_ROWS && part.layout <= GRAZE_MESH,
         name + ": expected a layout of 0 to 2, found " + std::to_string(part.layout));
  cuda::TriangleArray array;
  array.stride = stride_of(part.stride, element[part.layout], part.layout == GRAZE_MESH ? 4 : real, name);
  if (part.layout == GRAZE_MESH)
    array.vertex_stride = stride_of(part.vertex_stride, 3 * real, real, name + ".vertices");
  if (part.count == 0) return {};
  array.count = part.count;
  if (part.layout == GRAZE_ROWS) {
    expect_aligned(part.rows, name + ".rows", real);
    array.rows = static_cast<const char*>(part.rows);
    expect_fits(array.rows, part.count, array.stride, 9 * real, name + ".rows");
  } else if (part.layout == GRAZE_COLUMNS) {
    array.layout = cuda::Layout::columns;
    for (int k = 0; k < 9; ++k) {
      const std::string column = name + ".columns[" + std::to_string(k) + "]";
      expect_aligned(part.columns[k], column, real);
      expect_fits(part.columns[k], part.count, array.stride, real, column);
      array.columns[k] = static_cast<const char*>(part.columns[k]);
    }
  } else {
    array.layout = cuda::Layout::mesh;
    expect_aligned(part.faces, name + ".faces");
    expect_aligned(part.vertices, name + ".vertices", real);
    array.faces = reinterpret_cast<const char*>(part.faces);
    array.vertices = static_cast<const char*>(part.vertices);
    array.vertex_count = part.vertex_count;
    expect_fits(array.faces, part.count, array.stride, 12, name + ".faces");
    expect_fits(array.vertices, part.vertex_count, array.vertex_stride, 3 * real, name + ".vertices");
  }
  return array;
}

// A user's CUDA code runs in its own process, with or without a device, so a query treats it as a host lane.
bool is_of_device(const Lane& lane) { return lane.is_cuda() && !lane.foreign; }

// Returns the exact host lane for `exact`, whether the host or a device will run it.
Lane lane_of(const char* id) {
  const std::string name = id ? id : "exact";
  if (name == "exact") return *find_lane("exact/f32/cpu");
  if (const Lane* lane = find_lane(name)) return *lane;
  std::optional<LaneName> parts = parse_lane_name(name);
  const std::string policy = parts ? std::exchange(parts->policy, "") : "";
  const Lane* published = policy.empty() ? nullptr : find_lane(id_of(*parts));
  if (!published || published->exact)
    refuse("lane: expected exact or a lane of `graze lanes`, found '" + printable(name) + "'");
  try {
    return lane_under(*published, policy);
  } catch (const UsageError& error) {
    refuse(std::string("lane: ") + error.what());
  }
}

void check_outputs(const graze_query& query, const Question& question) {
  expect(!question.any || (!query.bytes && !query.bits && !query.list),
         "GRAZE_ANY: expected no outputs but the answer");
  if (query.list_room != 0) expect_aligned(query.list, "list", alignof(std::uint64_t));
  expect_fits(query.list, query.list_room, sizeof *query.list, sizeof *query.list, "list");
  if (query.bytes) expect_fits(query.bytes, query.reference_count * question.triangles, 1, 1, "bytes");
  if (query.bits) expect_fits(query.bits, query.reference_count * ((question.triangles + 7) / 8), 1, 1, "bits");
  if (query.bits) {
    for (std::size_t p = 0; p + 1 < question.counts.size(); ++p)
      expect(question.counts[p] % 64 == 0, "bits: expected a multiple of 64 triangles in every part except the last");
  }
  if (!query.outputs_on_device) return;
  expect(question.places.size() == 1 && question.places[0] >= 0 && !query.list,
         "outputs_on_device: expected a single part in a device's memory, and no list of hits");
}

int device_count(const std::string& wanted) {
  std::string why_not;
  const int count = cuda::count_query_devices(why_not);
  if (count == 0) throw QueryError(GRAZE_NO_DEVICE, wanted + ": there is no CUDA device: " + why_not);
  return count;
}

bool has_device() {
  std::string why_not;
  return cuda::count_query_devices(why_not) > 0;
}

// Whether a device would answer sooner than the cores, including its start-up time.
bool device_is_faster(const Question& question, int threads) {
  const double triangles = static_cast<double>(question.triangles),
               to_device = kToDevice * (question.in_doubles ? 2 : 1);
  const double by_cores = triangles * static_cast<double>(question.reference_count) * kOnCore / threads;
  return by_cores > kStart + triangles * to_device && has_device();
}

void choose_executor(const graze_query& query, bool any_lane, Question& question) {
  const bool resident = std::any_of(question.places.begin(), question.places.end(), [](int p) { return p >= 0; });
  const int cores = tbb::info::default_concurrency();
  const DecideBlock decide = on_cores(question.lane);
  auto executor = static_cast<graze_executor>(query.executor);
  if (executor == GRAZE_AUTO) {
    const bool small = question.triangles * question.reference_count < kWorthThreads;
    const bool on_device = resident || (is_of_device(question.lane) && (!decide || has_device())) ||
                           (any_lane && device_is_faster(question, cores));
    executor = on_device ? GRAZE_ALL_GPUS : small ? GRAZE_ONE_CORE : GRAZE_ALL_CORES;
  }
  question.executor = executor;
  if (executor == GRAZE_ONE_CORE || executor == GRAZE_ALL_CORES) {
    expect(!resident, "executor: expected GPUs for triangles in a device's memory, found cores");
    expect(static_cast<bool>(decide), "lane: expected a lane of the host for cores, found '" + question.lane.id + "'");
    question.lane.decide = decide;
    question.threads = executor == GRAZE_ONE_CORE ? 1 : cores;
    return;
  }
  expect(any_lane || is_of_device(question.lane),
         "lane: expected a CUDA lane for GPUs, found '" + question.lane.id + "'");
  const int count = device_count("executor");
  if (any_lane) question.lane = *find_lane(question.in_doubles ? "exact/f64/cuda" : "exact/f32/cuda");
  if (!resident) {
    for (int d = 0; d < (executor == GRAZE_ONE_GPU ? 1 : count); ++d) question.devices.push_back(d);
    return;
  }
  for (const int place : question.places) {
    expect(place >= 0 && place < count, "parts: expected every part on one of the devices 0 to " +
                                            std::to_string(count - 1) + ", or all in host memory, found " +
                                            std::to_string(place));
    if (std::find(question.devices.begin(), question.devices.end(), place) == question.devices.end())
      question.devices.push_back(place);
  }
  expect(executor == GRAZE_ALL_GPUS || question.devices.size() == 1,
         "executor: expected parts on one device, found more");
  expect(!query.stream || question.devices.size() == 1, "stream: expected one device, found several");
}

}  // namespace

DecideBlock (*on_cores)(const Lane& lane) = [](const Lane& lane) { return lane.decide; };

Question question_of(const graze_query& query) {
  Question question;
  expect(query.size == sizeof query,
         "size: expected " + std::to_string(sizeof query) + ", found " + std::to_string(query.size));
  expect(query.mode == GRAZE_ANY || query.mode == GRAZE_ALL,
         "mode: expected 0 or 1, found " + std::to_string(query.mode));
  question.any = query.mode == GRAZE_ANY;
  expect(query.executor >= GRAZE_AUTO && query.executor <= GRAZE_ALL_GPUS,
         "executor: expected 0 to 4, found " + std::to_string(query.executor));
  expect(query.coordinates == GRAZE_F32 || query.coordinates == GRAZE_F64,
         "coordinates: expected 0 or 1, found " + std::to_string(query.coordinates));
  question.in_doubles = query.coordinates == GRAZE_F64;
  const std::size_t real = question.in_doubles ? sizeof(double) : sizeof(float);
  expect(query.launch_seconds >= 0,
         "launch_seconds: expected at least 0, found " + std::to_string(query.launch_seconds));
  expect(query.reference_count >= 1 && query.reference_count <= kMostReferences,
         "references: expected 1 to 65536, found " + std::to_string(query.reference_count));
  expect_aligned(query.references, "references", real);
  expect_fits(query.references, query.reference_count, 9 * real, 9 * real, "references");
  question.references = query.references;
  question.reference_count = query.reference_count;
  expect(query.part_count >= 1 && query.parts, "parts: expected at least one, found none");
  expect(query.part_count <= kMostParts, "parts: expected at most 65536, found " + std::to_string(query.part_count));
  expect_aligned(query.parts, "parts", alignof(graze_triangles));
  expect_fits(query.parts, query.part_count, sizeof *query.parts, sizeof *query.parts, "parts");
  for (std::uint64_t p = 0; p < query.part_count; ++p) {
    const graze_triangles& part = query.parts[p];
    question.parts.push_back(array_of(part, real, "parts[" + std::to_string(p) + "]"));
    expect(part.device >= -1, "parts: expected a device, or -1, found " + std::to_string(part.device));
    question.counts.push_back(part.count);
    question.places.push_back(part.device);
    question.triangles += part.count;
    expect(question.triangles <= kMostTriangles, "parts: expected at most 2^48 triangles, found more");
  }
  expect(question.triangles <= kMostPairs / query.reference_count,
         "parts: expected at most 2^62 pairs of a triangle and a reference, found more");
  question.lane = lane_of(query.lane);
  expect(question.lane.is_cuda() || runs_on_this_cpu(question.lane),
         "lane: expected a lane that this processor can run, found '" + question.lane.id + "'");
  expect(!question.in_doubles || question.lane.exact,
         "lane: expected exact for doubles, found '" + question.lane.id + "'");
  check_outputs(query, question);
  choose_executor(query, question.lane.exact && !question.lane.is_cuda(), question);
  if (query.outputs_on_device) question.bytes = query.bytes, question.bits = query.bits;
  question.stream = query.stream;
  if (query.launch_seconds > 0) question.launch_seconds = query.launch_seconds;
  return question;
}

}  // namespace graze::query
