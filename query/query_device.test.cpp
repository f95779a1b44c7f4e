// SPDX-License-Identifier: Apache-2.0
// Devices give the same answers as the cores, for every layout (streamed and resident), every output, some lanes and
// all strata. Part of graze_device_test; skipped without a device.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "cuda/query/device_rows.h"
#include "query/testing.h"

namespace graze::query {
namespace {

// A copy of the vector in the memory of device 0.
template <class Element>
std::unique_ptr<cuda::DeviceMemory> copied(const std::vector<Element>& host) {
  auto memory = cuda::device_memory(0, host.size() * sizeof host[0]);
  memory->fill(host.data(), memory->bytes);
  return memory;
}

class QueryDevice : public testing::Test {
 protected:
  void SetUp() override {
    if (graze_devices() > 0) return;
    const char* required = std::getenv("GRAZE_REQUIRE_DEVICE");
    if (required && required[0] == '1') FAIL() << "a device is required, found none";
    GTEST_SKIP() << "no device";
  }

  struct Found {
    Answer answer;
    std::vector<std::uint8_t> bytes, bits;
    std::vector<std::uint64_t> list;
  };

  Found all_of(graze_query query, std::size_t count, bool lists = true) {
    Found found;
    found.bytes.resize(count * query.reference_count);
    found.bits.resize((count + 7) / 8 * query.reference_count);
    found.list.resize(lists ? count * query.reference_count : 0);
    query.bytes = found.bytes.data();
    query.bits = found.bits.data();
    if (lists) query.list = found.list.data();
    query.list_room = found.list.size();
    found.answer = context_.run(query);
    EXPECT_TRUE(found.answer) << found.answer.what();
    return found;
  }

  void expect_same(const Found& left, const Found& right) {
    EXPECT_EQ(left.bytes, right.bytes);
    EXPECT_EQ(left.bits, right.bits);
    EXPECT_EQ(left.list, right.list);
    EXPECT_EQ(left.answer.hits, right.answer.hits);
    EXPECT_EQ(left.answer.declined, right.answer.declined);
    EXPECT_EQ(left.answer.first, right.answer.first);
    EXPECT_EQ(left.answer.first_reference, right.answer.first_reference);
    EXPECT_EQ(left.answer.position, right.answer.position);
  }

  // The same triangles in device 0's memory.
  template <class Triangle>
  std::unique_ptr<cuda::DeviceMemory> resident(const std::vector<Triangle>& triangles, graze_triangles& part) {
    auto memory = cuda::device_memory(0, std::max<std::size_t>(1, triangles.size()) * sizeof(Triangle));
    memory->fill(triangles.data(), triangles.size() * sizeof(Triangle));
    part = rows_of(std::span<const Triangle>(triangles));
    part.device = 0;
    part.rows = memory->data;
    return memory;
  }

  // Queries the triangles in each layout, streamed and resident. One face has an index out of range.
  template <class Real>
  void expect_every_layout(const std::vector<std::array<Real, 9>>& triangles, const std::array<Real, 9>& reference) {
    EveryLayout<Real> layouts(triangles);
    layouts.faces[70'000][2] = 4'000'000'000u;
    const auto rows = copied(layouts.rows), wide = copied(layouts.wide), vertices = copied(layouts.vertices),
               faces = copied(layouts.faces);
    std::vector<graze_triangles> host = layouts.parts(), device = host;
    for (graze_triangles& part : device) part.device = 0;
    device[0].rows = rows->data;
    device[1].rows = wide->data;
    std::vector<std::unique_ptr<cuda::DeviceMemory>> columns;
    for (std::size_t k = 0; k < 9; ++k) {
      columns.push_back(copied(layouts.columns[k]));
      device[2].columns[k] = columns[k]->data;
    }
    device[3].vertices = vertices->data;
    device[3].faces = static_cast<const std::uint32_t*>(faces->data);
    for (graze_triangles* part : {&host[0], &device[0]}) {
      part->rows = static_cast<const Real*>(part->rows) + 9;  // not aligned for vector loads
      --part->count;
    }
    for (std::size_t k = 0; k < host.size(); ++k) {
      SCOPED_TRACE(k);
      graze_query query = query_of(reference, host[k]);
      query.executor = GRAZE_ALL_CORES;
      const Found cores = all_of(query, host[k].count);
      EXPECT_GT(cores.answer.hits, 1000u);
      query.executor = GRAZE_ONE_GPU;
      expect_same(all_of(query, host[k].count), cores);
      query.parts = &device[k];
      expect_same(all_of(query, host[k].count), cores);
    }
  }

  Context context_;
};

std::vector<Triangle> broken(std::vector<Triangle> triangles) {
  for (std::size_t i = 3; i < triangles.size(); i += 1001) triangles[i][i % 9] = i % 2 ? NAN : -INFINITY;
  return triangles;
}

TEST_F(QueryDevice, StreamedAndResidentAreTheCores) {
  const std::vector<Triangle> references = {
      kThesisReference, {0, 0, 0, 1, 0, 0, 0, 1, 0}, {NAN, 0, 0, 1, 0, 0, 0, 1, 0}};
  for (const std::size_t count : {0, 1, 31, 33, 64, 1000, 100'003, 3'000'001}) {
    const std::vector<Triangle> triangles = broken(thesis_triangles(count));
    graze_triangles part = part_of(triangles), on_device;
    const auto memory = resident(triangles, on_device);
    graze_query query = query_of(references[0], part);
    query.reference_count = count < 1'000'000 ? 3 : 1;
    query.executor = GRAZE_ALL_CORES;
    const Found cores = all_of(query, count);
    for (const int executor : {GRAZE_ONE_GPU, GRAZE_ALL_GPUS}) {
      query.executor = executor;
      query.parts = &part;
      expect_same(all_of(query, count), cores);
      query.parts = &on_device;
      expect_same(all_of(query, count), cores);
      const Answer counted = context_.run(query);
      EXPECT_EQ(counted.hits, cores.answer.hits);
      EXPECT_EQ(counted.declined, cores.answer.declined);
      EXPECT_EQ(counted.first, cores.answer.first);
    }
    // Outputs on the device, on the caller's stream; 2 is CUDA's handle for the per-thread default stream.
    auto bytes = cuda::device_memory(0, count * 3 + 1), bits = cuda::device_memory(0, (count + 7) / 8 * 3 + 1);
    query.outputs_on_device = 1;
    query.stream = reinterpret_cast<void*>(2);
    query.bytes = static_cast<unsigned char*>(bytes->data);
    query.bits = static_cast<unsigned char*>(bits->data);
    ASSERT_TRUE(context_.run(query)) << context_.run(query).what();
    Found found = cores;
    bytes->fetch(found.bytes.data(), found.bytes.size());
    bits->fetch(found.bits.data(), found.bits.size());
    expect_same(found, cores);
  }
}

// Queries the second triangles of a stratum's pairs with a few of the first triangles as references.
TEST_F(QueryDevice, AllStrataAreTheCores) {
  for (const strata::StratumInfo& row : strata::kStrata) {
    std::vector<Triangle> references, triangles;
    for (std::uint64_t i = 0; i < 200'000; ++i) {
      const Pair pair = strata::generate(11, row.stratum, i);
      if (i % 25'000 == 0) references.push_back(triangle(pair.a));
      triangles.push_back(triangle(pair.b));
      if (i % 16 == 0) triangles.push_back(references.back());
    }
    graze_triangles on_device;
    const auto memory = resident(triangles, on_device);
    const graze_triangles part = part_of(triangles);
    graze_query query = query_of(references[0], part);
    query.reference_count = references.size();
    query.executor = GRAZE_ALL_CORES;
    const Found cores = all_of(query, triangles.size());
    EXPECT_GT(cores.answer.hits, 10'000u);
    query.executor = GRAZE_ONE_GPU;
    query.parts = &on_device;
    SCOPED_TRACE(row.id);
    expect_same(all_of(query, triangles.size()), cores);
  }
}

// Queries the second triangles of a stratum's pairs with all first triangles as references.
TEST_F(QueryDevice, ManyReferencesAreTheCores) {
  for (const strata::StratumInfo& row : strata::kStrata) {
    std::vector<Triangle> references, triangles;
    for (std::uint64_t i = 0; i < 500; ++i) {
      const Pair pair = strata::generate(12, row.stratum, i);
      references.push_back(triangle(pair.a));
      triangles.push_back(triangle(pair.b));
    }
    const graze_triangles part = part_of(triangles);
    graze_query query = query_of(references[0], part);
    query.reference_count = references.size();
    query.executor = GRAZE_ALL_CORES;
    const Found cores = all_of(query, triangles.size());
    query.executor = GRAZE_ONE_GPU;
    SCOPED_TRACE(row.id);
    expect_same(all_of(query, triangles.size()), cores);
  }
}

TEST_F(QueryDevice, LayoutsAreTheCores) { expect_every_layout(broken(thesis_triangles(100'003)), kThesisReference); }

// Queries doubles of all strata, streamed and resident, with few and with many references. Some coordinates are not
// finite.
TEST_F(QueryDevice, DoublesOfAllStrataAreTheCores) {
  for (const strata::StratumInfo& row : strata::kDoubleStrata) {
    SCOPED_TRACE(row.id);
    for (const std::size_t each : {25'000, 200}) {
      std::vector<DoubleTriangle> references, triangles;
      for (std::uint64_t i = 0; i < (each == 200 ? 40'000u : 100'000u); ++i) {
        const DoublePair pair = strata::generate_doubles(13, row.stratum, i);
        if (i % each == 0) references.push_back(triangle(pair.a));
        triangles.push_back(triangle(pair.b));
        if (i % 16 == 0) triangles.push_back(references.back());
        if (i % 1001 == 3) triangles.back()[i % 9] = i % 2 ? NAN : -INFINITY;
      }
      references.push_back(references.front());
      references.back()[4] = INFINITY;
      graze_triangles on_device;
      const auto memory = resident(triangles, on_device);
      const graze_triangles part = rows_of(std::span<const DoubleTriangle>(triangles));
      graze_query query = query_of(references[0], part);
      query.reference_count = references.size();
      query.executor = GRAZE_ALL_CORES;
      const Found cores = all_of(query, triangles.size());
      EXPECT_GT(cores.answer.hits, 2'000u);
      EXPECT_GT(cores.answer.declined, triangles.size());
      query.executor = GRAZE_ONE_GPU;
      expect_same(all_of(query, triangles.size()), cores);
      query.parts = &on_device;
      expect_same(all_of(query, triangles.size()), cores);
      query.mode = GRAZE_ANY;
      EXPECT_EQ(context_.run(query).first, cores.answer.first);
    }
  }
}

TEST_F(QueryDevice, DoublesInEveryLayoutAreTheCores) {
  std::vector<DoubleTriangle> triangles;
  for (std::uint64_t i = 0; i < 100'003; ++i)
    triangles.push_back(triangle(strata::generate_doubles(14, strata::Stratum::uniform, i).b));
  expect_every_layout(triangles, triangle(strata::generate_doubles(14, strata::Stratum::uniform, 0).a));
}

TEST_F(QueryDevice, LanesAreThoseOfTheCores) {
  const std::vector<Triangle> triangles = broken(thesis_triangles(1'500'000, 5));
  graze_triangles on_device;
  const auto memory = resident(triangles, on_device);
  const graze_triangles part = part_of(triangles);
  for (const char* subject : {"interval_overlap/f32", "moller_1997/f64", "separating_axes/f32"}) {
    for (const char* policy : {"", "/rel:24", "/filtered"}) {
      const std::string of_core = std::string(subject) + "/cpu" + policy,
                        of_device = std::string(subject) + "/cuda-nofma" + policy;
      SCOPED_TRACE(of_core);
      graze_query query = query_of(kThesisReference, part);
      query.lane = of_core.c_str();
      const Found cores = all_of(query, triangles.size(), false);
      query.lane = of_device.c_str();
      expect_same(all_of(query, triangles.size(), false), cores);
      query.parts = &on_device;
      expect_same(all_of(query, triangles.size(), false), cores);
    }
  }
}

TEST_F(QueryDevice, AnyFindsTheFirst) {
  const Triangle far = {100, 100, 100, 101, 100, 100, 100, 101, 100};
  for (const std::size_t at : {0, 99, 4'095, 4'096, 70'000, 2'999'999}) {
    std::vector<Triangle> triangles(3'000'000, far);
    triangles[at] = kThesisReference;
    if (at > 50) triangles[50][3] = triangles[at - 1][2] = NAN;
    triangles.back() = kThesisReference;
    graze_triangles on_device;
    const auto memory = resident(triangles, on_device);
    const graze_triangles part = part_of(triangles);
    graze_query query = query_of(kThesisReference, part);
    query.mode = GRAZE_ANY;
    for (const graze_triangles* where : std::initializer_list<const graze_triangles*>{&part, &on_device}) {
      query.parts = where;
      query.executor = GRAZE_ALL_GPUS;
      const Answer answer = context_.run(query);
      EXPECT_EQ(answer.hits, 1u) << answer.what();
      EXPECT_EQ(answer.first, at);
      EXPECT_EQ(answer.position, at + 1);
      EXPECT_EQ(answer.declined, at > 50 ? 2u : 0u);
    }
  }
}

// Queries the same triangles in host memory, and as parts in the memory of every device.
TEST_F(QueryDevice, PartsOnAllDevices) {
  const std::vector<Triangle> triangles = broken(thesis_triangles(500'032));
  const graze_triangles part = part_of(triangles);
  graze_query query = query_of(kThesisReference, part);
  query.executor = GRAZE_ALL_CORES;
  std::vector<Triangle> all;
  std::vector<std::unique_ptr<cuda::DeviceMemory>> memories;
  std::vector<graze_triangles> parts;
  for (int d = 0; d < graze_devices(); ++d) {
    all.insert(all.end(), triangles.begin(), triangles.end());
    memories.push_back(cuda::device_memory(d, triangles.size() * sizeof(Triangle)));
    memories.back()->fill(triangles.data(), memories.back()->bytes);
    parts.push_back(part);
    parts.back().device = d;
    parts.back().rows = static_cast<const float*>(memories.back()->data);
  }
  const graze_triangles of_all = part_of(all);
  query.parts = &of_all;
  const Found cores = all_of(query, all.size());
  query.executor = GRAZE_ALL_GPUS;
  expect_same(all_of(query, all.size()), cores);
  query.parts = parts.data();
  query.part_count = parts.size();
  expect_same(all_of(query, all.size()), cores);
}

// Short launches make many chunks. The answer does not change, and no launch exceeds the limit. The first launches are
// small and measure how long one takes.
TEST_F(QueryDevice, LaunchesAreSplit) {
  const std::vector<Triangle> some = thesis_triangles(1 << 20);
  auto memory = cuda::device_memory(0, std::size_t{36} << 26);
  memory->fill(some.data(), some.size() * sizeof(Triangle));
  graze_triangles part = part_of(some);
  part.count = 1 << 26;
  part.device = 0;
  part.rows = static_cast<const float*>(memory->data);
  graze_query query = query_of(kThesisReference, part);
  const Answer whole = context_.run(query);
  query.launch_seconds = 2e-4;
  const Answer split = context_.run(query);
  ASSERT_TRUE(whole && split);
  EXPECT_EQ(whole.hits, 64 * context_.count(kThesisReference, part_of(some)).hits);
  EXPECT_EQ(split.hits, whole.hits);
  EXPECT_LT(split.longest_launch, 2e-4);
  EXPECT_GT(whole.longest_launch, 2e-4);
}

TEST_F(QueryDevice, LackOfDeviceMemoryIsAValueOrSmallerChunks) {
  std::vector<std::unique_ptr<cuda::DeviceMemory>> hoard;
  for (std::size_t bytes = std::size_t{1} << 36; bytes >= std::size_t{1} << 22; bytes /= 2) {
    try {
      for (;;) hoard.push_back(cuda::device_memory(0, bytes));
    } catch (const cuda::DeviceFailure& failure) {
      EXPECT_TRUE(failure.out_of_memory);
    }
  }
  const std::vector<Triangle> triangles = thesis_triangles(3'000'000);
  const graze_triangles part = part_of(triangles);
  graze_query query = query_of(kThesisReference, part);
  query.executor = GRAZE_ONE_GPU;
  const Answer answer = Context().run(query);
  if (!answer) {
    EXPECT_EQ(answer.status, GRAZE_NO_MEMORY) << answer.what();
    EXPECT_LT(answer.position, part.count);
  }
  hoard.clear();
  const Answer again = context_.run(query);
  ASSERT_TRUE(again) << again.what();
  query.executor = GRAZE_ALL_CORES;
  EXPECT_EQ(again.hits, context_.run(query).hits);
}

TEST_F(QueryDevice, CancelsAndGoesOn) {
  const std::vector<Triangle> triangles = thesis_triangles(5'000'000);
  const graze_triangles part = part_of(triangles);
  graze_query query = query_of(kThesisReference, part);
  query.executor = GRAZE_ONE_GPU;
  query.progress = [](void*, std::uint64_t, std::uint64_t) { return 1; };
  const Answer answer = context_.run(query);
  EXPECT_EQ(answer.status, GRAZE_CANCELLED);
  EXPECT_LT(answer.position, part.count);
  query.progress = nullptr;
  EXPECT_TRUE(context_.run(query));
}

}  // namespace
}  // namespace graze::query
