// SPDX-License-Identifier: Apache-2.0
// Results are combined in the order of the triangles, in whichever order they arrive, and even if one never arrives.
#include "query/collector.h"

#include <gtest/gtest.h>

#include <thread>

namespace graze::query {
namespace {

using cuda::QueryRange;

constexpr std::uint64_t kNone[] = {0}, kFifth[] = {32};

TEST(Collector, CountsInOrder) {
  Collector collector({192}, {-1}, 1, false, {}, {});
  QueryRange ranges[3], more;
  for (QueryRange& range : ranges) ASSERT_TRUE(collector.next(-1, 64, range));
  EXPECT_FALSE(collector.next(-1, 64, more));
  collector.take(ranges[2], kFifth, kNone, 1);
  collector.take(ranges[1], kNone, kFifth, 1);
  EXPECT_EQ(collector.found().position, 0u);
  EXPECT_EQ(collector.found().hits, 0u);
  collector.take(ranges[0], kFifth, kNone, 1);
  const Collector::Found found = collector.found();
  EXPECT_EQ(found.position, 192u);
  EXPECT_EQ(found.hits, 2u);
  EXPECT_EQ(found.declined, 1u);
  EXPECT_EQ(found.first, 5u);
}

// A worker failed on the first range, so nothing after it is certain.
TEST(Collector, KnowsHowFarItIsCertain) {
  Collector collector({192}, {-1}, 1, false, {}, {});
  QueryRange ranges[2], more;
  for (QueryRange& range : ranges) ASSERT_TRUE(collector.next(-1, 64, range));
  collector.take(ranges[1], kFifth, kNone, 1);
  collector.stop();
  EXPECT_FALSE(collector.next(-1, 64, more));
  EXPECT_EQ(collector.found().position, 0u);
}

TEST(Collector, AnyIsTheFirstOfWhatWasBegun) {
  Collector collector({640}, {-1}, 1, true, {}, {});
  QueryRange ranges[3], more;
  for (QueryRange& range : ranges) ASSERT_TRUE(collector.next(-1, 64, range));
  collector.take(ranges[2], kFifth, kNone, 1);
  EXPECT_FALSE(collector.next(-1, 64, more));  // a hit ends the search for all workers
  collector.take(ranges[1], kFifth, kNone, 1);
  collector.take(ranges[0], kNone, kFifth, 1);
  const Collector::Found found = collector.found();
  EXPECT_EQ(found.first, 69u);
  EXPECT_EQ(found.hits, 1u);
  EXPECT_EQ(found.position, 70u);
  EXPECT_EQ(found.declined, 1u);
}

TEST(Collector, DevicesTakeTheirOwnParts) {
  Collector collector({64, 128, 64}, {0, 1, 0}, 1, false, {}, {});
  QueryRange range;
  ASSERT_TRUE(collector.next(1, 64, range));
  EXPECT_EQ(range.first, 64u);
  EXPECT_EQ(range.part, 1u);
  ASSERT_TRUE(collector.next(1, 64, range));
  EXPECT_EQ(range.first_in_part, 64u);
  EXPECT_FALSE(collector.next(1, 64, range));
  ASSERT_TRUE(collector.next(0, 64, range));
  ASSERT_TRUE(collector.next(0, 1000, range));
  EXPECT_EQ(range.first, 192u);
  EXPECT_EQ(range.count, 64u);
  EXPECT_FALSE(collector.next(-1, 64, range));
}

// A worker that waits for a range that never arrives must stop.
TEST(Collector, ListsDoNotWaitForThoseWhoFailed) {
  std::uint64_t list[2];
  Collector collector({192}, {-1}, 1, false, {nullptr, nullptr, list, 2}, {});
  QueryRange ranges[2];
  for (QueryRange& range : ranges) ASSERT_TRUE(collector.next(-1, 64, range));
  std::jthread other([&] { collector.take(ranges[1], kFifth, kNone, 1); });
  collector.stop();
  other.join();
  EXPECT_EQ(collector.found().hits, 0u);
}

}  // namespace
}  // namespace graze::query
