// SPDX-License-Identifier: Apache-2.0
// Tests the library. On the cores, every layout, output and executor gives the same answer. Wrong arguments, lack of
// memory and cancellation give an error status.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <new>
#include <string>
#include <thread>

#include "core/message_testing.h"
#include "query/testing.h"

namespace {

// If this counter is n > 0, the n-th allocation from now and all later ones fail. If it is -1, no allocation fails.
std::atomic<long> allocations_left = -1;

bool allocation_fails() {
  long left = allocations_left;
  while (left > 0 && !allocations_left.compare_exchange_weak(left, left - 1)) {
  }
  return left == 0 || left == 1;
}

}  // namespace

[[gnu::noinline]] void* operator new(std::size_t size) {
  void* memory = allocation_fails() ? nullptr : std::malloc(size == 0 ? 1 : size);
  if (!memory) throw std::bad_alloc();
  return memory;
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return allocation_fails() ? nullptr : std::malloc(size == 0 ? 1 : size);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace graze::query {
namespace {

constexpr std::size_t kCount = 100'003;  // not a multiple of any block size

struct Outputs {
  std::vector<std::uint8_t> bytes, bits;
  std::vector<std::uint64_t> list;
  Answer answer;
};

Outputs all_of(graze_query query, std::size_t count, std::size_t room) {
  Outputs outputs;
  outputs.bytes.resize(count * query.reference_count);
  outputs.bits.resize((count + 7) / 8 * query.reference_count);
  outputs.list.assign(room + 1, 77);
  query.bytes = outputs.bytes.data();
  query.bits = outputs.bits.data();
  query.list = outputs.list.data();
  query.list_room = room;
  outputs.answer = Context().run(query);
  EXPECT_TRUE(outputs.answer) << outputs.answer.what();
  return outputs;
}

void expect_refused(const graze_query& query, const std::string& message) {
  const Answer answer = Context().run(query);
  EXPECT_EQ(answer.status, GRAZE_BAD_ARGUMENT);
  EXPECT_EQ(answer.what(), message);
  EXPECT_EQ(answer.hits + answer.position, 0u);
}

TEST(Query, OutputsTellTheSameOnOneCoreAndOnAll) {
  std::vector<Triangle> triangles = thesis_triangles(kCount);
  triangles[5][3] = NAN;
  triangles[kCount - 1][8] = INFINITY;
  const std::vector<Triangle> references = {
      kThesisReference, {0, 0, 0, 1, 0, 0, 0, 1, 0}, {NAN, 0, 0, 1, 0, 0, 0, 1, 0}};
  const graze_triangles part = part_of(triangles);
  graze_query query = query_of(references[0], part);
  query.reference_count = references.size();
  std::vector<std::uint8_t> bytes;
  for (const int executor : {GRAZE_ONE_CORE, GRAZE_ALL_CORES, GRAZE_AUTO}) {
    query.executor = executor;
    const Outputs found = all_of(query, kCount, 3 * kCount);
    if (executor == GRAZE_ONE_CORE) bytes = found.bytes;
    EXPECT_EQ(found.bytes, bytes);
    std::vector<std::uint64_t> list;
    std::uint64_t declined = 0;
    for (std::size_t i = 0; i < kCount; ++i) {
      for (std::size_t r = 0; r < 3; ++r) {
        const std::uint8_t byte = bytes[r * kCount + i];
        declined += byte == 2;
        if (byte == 1) list.push_back(3 * i + r);
        EXPECT_EQ(found.bits[r * ((kCount + 7) / 8) + i / 8] >> i % 8 & 1, byte == 1);
      }
    }
    EXPECT_EQ(declined, kCount + 4);
    EXPECT_EQ(found.answer.declined, declined);
    EXPECT_GT(list.size(), kCount / 10);
    EXPECT_EQ(found.answer.hits, list.size());
    EXPECT_EQ(found.answer.first, list[0] / 3);
    EXPECT_EQ(found.answer.first_reference, list[0] % 3);
    EXPECT_EQ(found.answer.position, kCount);
    EXPECT_TRUE(std::equal(list.begin(), list.end(), found.list.begin()));
    EXPECT_EQ(found.list[list.size()], 77u);
    EXPECT_EQ(all_of(query, kCount, 10).list,
              (std::vector<std::uint64_t>{list[0], list[1], list[2], list[3], list[4], list[5], list[6], list[7],
                                          list[8], list[9], 77}));
  }
}

TEST(Query, LayoutsTellTheSame) {
  const std::vector<Triangle> triangles = thesis_triangles(kCount);
  const Outputs rows = all_of(query_of(kThesisReference, part_of(triangles)), kCount, 0);
  EveryLayout<float> layouts(triangles);
  EXPECT_EQ(layouts.parts()[1].stride, 40u);
  for (const graze_triangles& part : layouts.parts())
    EXPECT_EQ(all_of(query_of(kThesisReference, part), kCount, 0).bytes, rows.bytes);
  layouts.faces[9][1] = static_cast<std::uint32_t>(layouts.vertices.size());
  const graze_triangles mesh = layouts.parts()[3];
  const Outputs beside = all_of(query_of(kThesisReference, mesh), kCount, 0);
  EXPECT_EQ(beside.bytes[9], 2);
  EXPECT_EQ(beside.answer.declined, 1u);

  // The same array in several parts, one of which is empty.
  std::vector<graze_triangles> parts(3, part_of(triangles));
  parts[0].count = 64 * 100;
  parts[1].count = 0;
  parts[2].count -= 64 * 100;
  parts[2].rows = triangles.data() + 64 * 100;
  graze_query query = query_of(kThesisReference, parts[0]);
  query.part_count = 3;
  EXPECT_EQ(all_of(query, kCount, 0).bytes, rows.bytes);
}

// In every layout, doubles give the same results as the same numbers in float.
TEST(Query, DoublesInEveryLayoutTellTheSame) {
  const std::vector<Triangle> floats = thesis_triangles(kCount);
  const std::vector<std::uint8_t> bytes = all_of(query_of(kThesisReference, part_of(floats)), kCount, 0).bytes;
  DoubleTriangle reference;
  std::copy(kThesisReference.begin(), kThesisReference.end(), reference.begin());
  const EveryLayout<double> layouts(floats);
  for (const graze_triangles& part : layouts.parts()) {
    for (const int executor : {GRAZE_ONE_CORE, GRAZE_ALL_CORES, GRAZE_AUTO}) {
      graze_query query = query_of(reference, part);
      query.executor = executor;
      EXPECT_EQ(all_of(query, kCount, 0).bytes, bytes);
    }
    graze_query query = query_of(reference, part);
    query.mode = GRAZE_ANY;
    EXPECT_EQ(bytes[Context().run(query).first], 1);
  }
}

TEST(Query, DoublesAreForTheExactLane) {
  const std::vector<DoubleTriangle> triangles(10, DoubleTriangle{0, 0, 0, 1, 0, 0, 0, 1, 0});
  graze_triangles part = rows_of(std::span<const DoubleTriangle>(triangles));
  const auto wrong = [&](const auto& change, const std::string& message) {
    part = rows_of(std::span<const DoubleTriangle>(triangles));
    graze_query query = query_of(triangles[0], part);
    change(query);
    expect_refused(query, message);
  };
  wrong([](auto& q) { q.coordinates = 2; }, "coordinates: expected 0 or 1, found 2");
  wrong([](auto& q) { q.lane = "moller_1997/f64/cpu"; },
        "lane: expected exact for doubles, found 'moller_1997/f64/cpu'");
  wrong([](auto& q) { q.lane = "moller_1997/f64/cuda-fma"; },
        "lane: expected exact for doubles, found 'moller_1997/f64/cuda-fma'");
  wrong([&](auto&) { part.stride = 76; },
        "parts[0]: expected a stride of 72 to 9223372036854775807 bytes that is a multiple of 8, found 76");
  wrong([&](auto&) { part.rows = static_cast<const float*>(part.rows) + 1; },
        "parts[0].rows: expected a pointer that is a multiple of 8");
  wrong([](auto& q) { q.references = static_cast<const float*>(q.references) + 1; },
        "references: expected a pointer that is a multiple of 8");
}

TEST(Query, AnyFindsTheFirstOnAnyNumberOfCores) {
  const Triangle far = {100, 100, 100, 101, 100, 100, 100, 101, 100};
  for (const std::size_t at : {0, 63, 64, 99, 5'000, 99'999, 300'000}) {
    std::vector<Triangle> triangles(400'000, far);
    triangles[at] = kThesisReference;
    triangles.back() = kThesisReference;
    triangles[at / 2 + 1][0] = at / 2 + 1 == at ? triangles[at][0] : NAN;
    const graze_triangles part = part_of(triangles);
    for (const int executor : {GRAZE_ONE_CORE, GRAZE_ALL_CORES}) {
      graze_query query = query_of(kThesisReference, part);
      query.mode = GRAZE_ANY;
      query.executor = executor;
      const Answer answer = Context().run(query);
      EXPECT_EQ(answer.hits, 1u);
      EXPECT_EQ(answer.first, at);
      EXPECT_EQ(answer.position, at + 1);
      EXPECT_EQ(answer.declined, at / 2 + 1 < at ? 1u : 0u);
    }
  }
  const std::vector<Triangle> none(1000, far);
  const Answer answer = Context().any(kThesisReference, part_of(none));
  EXPECT_TRUE(answer);
  EXPECT_EQ(answer.hits, 0u);
  EXPECT_EQ(answer.first, UINT64_MAX);
  EXPECT_EQ(answer.position, 1000u);
}

TEST(Query, NothingIsNoTriangle) {
  const graze_triangles part = part_of({});
  for (const int mode : {GRAZE_ANY, GRAZE_ALL}) {
    graze_query query = query_of(kThesisReference, part);
    query.mode = mode;
    const Answer answer = Context().run(query);
    EXPECT_TRUE(answer);
    EXPECT_EQ(answer.hits + answer.triangles + answer.declined, 0u);
  }
}

TEST(Query, WrongArgumentsAreNamed) {
  const std::vector<Triangle> triangles = thesis_triangles(10);
  graze_triangles part = part_of(triangles);
  const graze_query right = query_of(kThesisReference, part);
  const auto wrong = [&](const auto& change, const std::string& message) {
    graze_query query = right;
    part = part_of(triangles);
    change(query);
    expect_refused(query, message);
  };
  std::uint8_t bytes[10];
  wrong([](auto& q) { q.size = 8; }, "size: expected " + std::to_string(sizeof(graze_query)) + ", found 8");
  wrong([](auto& q) { q.mode = 2; }, "mode: expected 0 or 1, found 2");
  wrong([](auto& q) { q.executor = 5; }, "executor: expected 0 to 4, found 5");
  wrong([](auto& q) { q.launch_seconds = -1; }, "launch_seconds: expected at least 0, found -1.000000");
  wrong([](auto& q) { q.reference_count = 0; }, "references: expected 1 to 65536, found 0");
  wrong([](auto& q) { q.references = nullptr; }, "references: expected a pointer, found NULL");
  wrong([](auto& q) { q.references = reinterpret_cast<const float*>(2); },
        "references: expected a pointer that is a multiple of 4");
  wrong([](auto& q) { q.part_count = 0; }, "parts: expected at least one, found none");
  wrong([](auto& q) { q.parts = nullptr; }, "parts: expected at least one, found none");
  wrong([](auto& q) { q.part_count = UINT64_MAX; }, "parts: expected at most 65536, found 18446744073709551615");
  wrong([&](auto& q) { q.parts = reinterpret_cast<const graze_triangles*>(reinterpret_cast<const char*>(&part) + 4); },
        "parts: expected a pointer that is a multiple of 8");
  wrong([&](auto&) { part.rows = nullptr; }, "parts[0].rows: expected a pointer, found NULL");
  wrong([&](auto&) { part.stride = 12; },
        "parts[0]: expected a stride of 36 to 9223372036854775807 bytes that is a multiple of 4, found 12");
  wrong([&](auto&) { part.stride = 38; },
        "parts[0]: expected a stride of 36 to 9223372036854775807 bytes that is a multiple of 4, found 38");
  wrong([&](auto&) { part.layout = 3; }, "parts[0]: expected a layout of 0 to 2, found 3");
  wrong([&](auto&) { part.layout = GRAZE_COLUMNS; }, "parts[0].columns[0]: expected a pointer, found NULL");
  wrong([&](auto&) { part.layout = GRAZE_MESH; }, "parts[0].faces: expected a pointer, found NULL");
  wrong([&](auto&) { part.count = UINT64_MAX; },
        "parts[0]: expected at most 2^48 triangles, found 18446744073709551615");
  wrong([&](auto&) { part.device = -2; }, "parts: expected a device, or -1, found -2");
  wrong([](auto& q) { q.lane = "moler"; }, "lane: expected exact or a lane of `graze lanes`, found 'moler'");
  wrong(
      [](auto& q) { q.lane = "moller_1997/f32/cpu/rel:x"; },
      "lane: expected a policy (zero, abs:E, rel:K, SITE=abs:E,…, paper, bound or filtered), found \"rel:x\": \"x\" is "
      "not a number of at least 0");
  wrong([](auto& q) { q.lane = "moller_1997/f32/cuda-fma", q.executor = GRAZE_ONE_CORE; },
        "lane: expected a lane of the host for cores, found 'moller_1997/f32/cuda-fma'");
  wrong([](auto& q) { q.lane = "moller_1997/f32/cpu", q.executor = GRAZE_ONE_GPU; },
        "lane: expected a CUDA lane for GPUs, found 'moller_1997/f32/cpu'");
  wrong([&](auto& q) { q.mode = GRAZE_ANY, q.bytes = bytes; }, "GRAZE_ANY: expected no outputs but the answer");
  wrong([](auto& q) { q.list_room = 1; }, "list: expected a pointer, found NULL");
  std::uint64_t list[10];
  wrong([&](auto& q) { q.list = list, q.list_room = SIZE_MAX; },
        "list: expected an array that fits into memory, found 18446744073709551615 elements, one every 8 bytes");
  wrong([&](auto& q) { q.list = reinterpret_cast<std::uint64_t*>(reinterpret_cast<char*>(list) + 4), q.list_room = 1; },
        "list: expected a pointer that is a multiple of 8");
  wrong([&](auto& q) { q.bytes = bytes, q.outputs_on_device = 1; },
        "outputs_on_device: expected a single part in a device's memory, and no list of hits");
  wrong([&](auto& q) { part.device = 0, q.executor = GRAZE_ONE_CORE; },
        "executor: expected GPUs for triangles in a device's memory, found cores");

  graze_answer answer;
  EXPECT_EQ(graze_run(nullptr, &right, &answer), GRAZE_BAD_ARGUMENT);
  EXPECT_STREQ(answer.message, "context: expected a pointer, found NULL");
  EXPECT_EQ(answer.first, UINT64_MAX);
  graze_context* context = graze_open();
  EXPECT_EQ(graze_run(context, nullptr, &answer), GRAZE_BAD_ARGUMENT);
  EXPECT_EQ(graze_run(context, &right, nullptr), GRAZE_BAD_ARGUMENT);
  graze_close(context);
}

// Ten triangles in a layout; at least one of them meets the thesis's reference.
struct InLayout {
  std::vector<Triangle> triangles = thesis_triangles(10);
  std::vector<std::array<std::uint32_t, 3>> faces;
  graze_triangles part;

  explicit InLayout(int layout) {
    triangles[7] = kThesisReference;
    for (std::uint32_t v = 0; v < 30; v += 3) faces.push_back({v, v + 1, v + 2});
    part = part_of(triangles);
    part.layout = layout;
    part.stride = 0;
    for (std::size_t k = 0; k < 9; ++k) part.columns[k] = triangles[0].data() + k;
    if (layout == GRAZE_COLUMNS) part.stride = 36;
    part.vertices = part.rows;
    part.vertex_count = 30;
    part.faces = faces[0].data();
  }
};

constexpr int kLayouts[] = {GRAZE_ROWS, GRAZE_COLUMNS, GRAZE_MESH};
constexpr std::size_t kElement[] = {36, 4, 12};  // bytes, by layout

TEST(Query, StridesThatNoArrayHasAreRefusedInEveryLayout) {
  for (const int layout : kLayouts) {
    InLayout all(layout);
    const std::uint64_t hits = Context().count(kThesisReference, all.part).hits;
    EXPECT_GT(hits, 0u);
    for (const int executor : {GRAZE_AUTO, GRAZE_ONE_CORE, GRAZE_ALL_CORES, GRAZE_ALL_GPUS}) {
      const auto status = [&](std::uint64_t count, std::size_t stride) {
        graze_triangles part = all.part;
        part.count = count;
        part.stride = stride;
        graze_query query = query_of(kThesisReference, part);
        query.executor = executor;
        return Context().run(query).status;
      };
      const std::size_t size = kElement[layout];
      for (const std::size_t stride :
           {std::size_t{1}, size - 1, size + 1, SIZE_MAX, SIZE_MAX - 35, SIZE_MAX - 3, SIZE_MAX / 2 + 1}) {
        for (const std::uint64_t count : {1, 2, 10}) EXPECT_EQ(status(count, stride), GRAZE_BAD_ARGUMENT) << stride;
      }
      // The size in bytes overflows to zero or to a small or large number, or the array ends beyond the address space.
      for (const std::size_t stride :
           {std::size_t{1} << 62, std::size_t{1} << 60, (SIZE_MAX / 9 + 1) / 4 * 4, SIZE_MAX / 2 / 9 / 4 * 4 + 4})
        EXPECT_EQ(status(10, stride), GRAZE_BAD_ARGUMENT) << stride;
      // An empty array needs no pointers, but its stride is checked.
      EXPECT_EQ(status(0, size + 1), GRAZE_BAD_ARGUMENT);
      EXPECT_EQ(status(GRAZE_MOST_TRIANGLES, std::size_t{1} << 16), GRAZE_BAD_ARGUMENT);
      EXPECT_EQ(status(GRAZE_MOST_TRIANGLES + 1, 0), GRAZE_BAD_ARGUMENT);
    }
    std::vector<std::uint8_t> bytes;
    graze_triangles many = all.part;
    many.count = UINT64_MAX;
    EXPECT_EQ(Context().all(kThesisReference, many, bytes).status, GRAZE_BAD_ARGUMENT);
  }
}

TEST(Query, VerticesThatNoArrayHasAreRefused) {
  InLayout all(GRAZE_MESH);
  const std::uint64_t hits = Context().count(kThesisReference, all.part).hits;
  EXPECT_GT(hits, 0u);
  const auto status = [&](std::uint64_t count, std::size_t stride) {
    graze_triangles part = all.part;
    part.vertex_count = count;
    part.vertex_stride = stride;
    return Context().count(kThesisReference, part).status;
  };
  EXPECT_EQ(status(30, 12), GRAZE_OK);
  for (const std::size_t stride : {std::size_t{1}, std::size_t{11}, std::size_t{13}, SIZE_MAX, SIZE_MAX - 11,
                                   SIZE_MAX - 3, std::size_t{1} << 62, (SIZE_MAX / 29 + 1) / 4 * 4})
    EXPECT_EQ(status(30, stride), GRAZE_BAD_ARGUMENT) << stride;
  EXPECT_EQ(status(UINT64_MAX, 12), GRAZE_BAD_ARGUMENT);
  EXPECT_EQ(status(UINT64_MAX / 12 + 2, 12), GRAZE_BAD_ARGUMENT);
}

TEST(Query, BitsOfPartsThatShareAWordAreRefused) {
  const std::vector<Triangle> triangles = thesis_triangles(100);
  const std::vector<graze_triangles> parts(2, part_of(triangles));
  graze_query query = query_of(kThesisReference, parts[0]);
  query.part_count = 2;
  EXPECT_TRUE(Context().run(query));
  std::uint8_t bits[25];
  query.bits = bits;
  expect_refused(query, "bits: expected a multiple of 64 triangles in every part except the last");
}

TEST(Query, CountsWhoseProductsOverflowAreRefused) {
  const std::vector<Triangle> triangles = thesis_triangles(10);
  std::vector<graze_triangles> parts(3, part_of(triangles));
  for (graze_triangles& part : parts) part.count = GRAZE_MOST_TRIANGLES / 2;
  graze_query query = query_of(kThesisReference, parts[0]);
  query.part_count = 3;
  expect_refused(query, "parts: expected at most 2^48 triangles, found more");
  query.part_count = 2;
  query.reference_count = 1 << 16;
  expect_refused(query, "parts: expected at most 2^62 pairs of a triangle and a reference, found more");
  query.reference_count = UINT64_MAX;
  expect_refused(query, "references: expected 1 to 65536, found 18446744073709551615");
}

TEST(Query, WithoutADeviceItSaysSo) {
  if (graze_devices() > 0) GTEST_SKIP() << "there is a device";
  const std::vector<Triangle> triangles = thesis_triangles(10);
  const graze_triangles part = part_of(triangles);
  for (const int executor : {GRAZE_ONE_GPU, GRAZE_ALL_GPUS}) {
    graze_query query = query_of(kThesisReference, part);
    query.executor = executor;
    const Answer answer = Context().run(query);
    EXPECT_EQ(answer.status, GRAZE_NO_DEVICE);
    EXPECT_TRUE(names(std::string(answer.what()), {"executor", "no CUDA device"}));
  }
}

TEST(Query, ProgressIsToldAndEndsIt) {
  const std::vector<Triangle> triangles = thesis_triangles(300'000);
  const graze_triangles part = part_of(triangles);
  graze_query query = query_of(kThesisReference, part);
  std::vector<std::uint64_t> told;
  query.user = &told;
  query.progress = [](void* user, std::uint64_t done, std::uint64_t all) {
    static_cast<std::vector<std::uint64_t>*>(user)->push_back(done);
    return all == 300'000 ? 0 : 1;
  };
  EXPECT_TRUE(Context().run(query));
  EXPECT_EQ(told.back(), 300'000u);
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));

  query.progress = [](void*, std::uint64_t, std::uint64_t) { return 1; };
  for (const int executor : {GRAZE_ONE_CORE, GRAZE_ALL_CORES}) {
    query.executor = executor;
    const Answer answer = Context().run(query);
    EXPECT_EQ(answer.status, GRAZE_CANCELLED);
    EXPECT_EQ(answer.what(), "cancelled by the progress callback");
    EXPECT_GT(answer.position, 0u);
    EXPECT_LT(answer.position, 300'000u);
  }
  query.progress = [](void*, std::uint64_t, std::uint64_t) -> int { throw 1; };
  EXPECT_EQ(Context().run(query).status, GRAZE_FAILED);
}

TEST(Query, ThreadsShareAContext) {
  const std::vector<Triangle> triangles = thesis_triangles(50'000);
  const graze_triangles part = part_of(triangles);
  const Context context;
  const std::uint64_t hits = context.count(kThesisReference, part).hits;
  std::atomic<int> right = 0;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 8; ++t)
      threads.emplace_back([&] { right += context.count(kThesisReference, part).hits == hits; });
  }
  EXPECT_EQ(right, 8);
}

// For each allocation in turn, this allocation and all later ones fail. The result must be an error status, or the
// right answer if memory was not needed.
TEST(Query, LackOfMemoryIsAValueWhereverItBegins) {
  std::vector<Triangle> triangles = thesis_triangles(100'000);
  const graze_triangles part = part_of(triangles);
  const Context context;
  const std::uint64_t hits = context.count(kThesisReference, part).hits;
  std::vector<std::uint64_t> list(hits);
  for (const char* lane : {static_cast<const char*>(nullptr), "moller_1997/f32/cpu/rel:8"}) {
    for (const int executor : {GRAZE_ONE_CORE, GRAZE_ALL_CORES}) {
      graze_query query = query_of(kThesisReference, part);
      query.executor = executor;
      query.lane = lane;
      query.list = list.data();
      query.list_room = hits;
      int failures = 0, done = 0;
      for (long n = 1; done < 3; ++n) {  // the number of allocations depends on the threads
        ASSERT_LT(n, 2000);
        allocations_left = n;
        const Answer answer = context.run(query);
        allocations_left = -1;
        if (answer) {
          done += 1;
          EXPECT_TRUE(lane || answer.hits == hits);
        } else {
          failures += 1;
          EXPECT_EQ(answer.status, GRAZE_NO_MEMORY) << n << ' ' << answer.what();
          EXPECT_TRUE(names(std::string(answer.what()), {"memory"}));
          EXPECT_LE(answer.position, triangles.size());
        }
      }
      EXPECT_GE(failures, 5);
    }
  }
  allocations_left = 1;
  graze_context* none = graze_open();
  allocations_left = -1;
  EXPECT_EQ(none, nullptr);
}

// One core finds a hit among the first hundred in less than a tenth of the time that it takes to reach the last
// triangle. Each time is the best of ten, because other programs may run at the same time.
TEST(Query, AHitAmongTheFirstIsFoundAtOnce) {
  const Triangle far = {100, 100, 100, 101, 100, 100, 100, 101, 100};
  const Context context;
  const auto best_with_hit_at = [&](std::size_t hit) {
    std::vector<Triangle> triangles(2'000'000, far);
    triangles[hit] = kThesisReference;
    const graze_triangles part = part_of(triangles);
    graze_query query = query_of(kThesisReference, part);
    query.mode = GRAZE_ANY;
    query.executor = GRAZE_ONE_CORE;
    double best = INFINITY;
    for (int k = 0; k < 10; ++k) {
      const Answer answer = context.run(query);
      EXPECT_EQ(answer.first, hit);
      best = std::min(best, answer.seconds);
    }
    return best;
  };
  EXPECT_LT(best_with_hit_at(99), 0.1 * best_with_hit_at(1'999'999));
}

}  // namespace
}  // namespace graze::query
