// SPDX-License-Identifier: Apache-2.0
#include "cuda/engine/signature_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <barrier>
#include <thread>
#include <vector>

#include "cuda/engine/engine_block.h"

namespace graze::cuda {
namespace {

constexpr std::uint32_t kWords = 5;

// A key whose number determines all its words, so the test detects incomplete keys. Reading word 2 lets other threads
// run.
struct TestKey {
  std::uint64_t number;
  std::uint64_t word(std::uint32_t k) const {
    if (k == 2) std::this_thread::yield();
    return number * (2 * k + 1) + k;
  }
};

class SignatureTableTest : public testing::Test {
 protected:
  SignatureTable table(std::uint32_t size) {
    SignatureTable t{nullptr, size, kWords, &full_};
    rows_.assign(std::size_t{size} * t.row_words(), 0);
    t.rows = rows_.data();
    for (std::uint32_t at = 0; at < size; ++at) std::fill_n(t.cases(t.row(at)), kEngineCases, kNoCase);
    return t;
  }

  std::vector<std::uint64_t> rows_;
  std::uint32_t full_ = 0;
};

// All threads add the same key at the same time, so they find rows that are being written.
TEST_F(SignatureTableTest, ManyThreadsNeverStoreHalfAKeyNorOneTwice) {
  constexpr std::uint64_t kThreadCount = 4, kKeys = 200, kPairs = 300;
  const SignatureTable t = table(1024);
  std::barrier together(kThreadCount);
  std::vector<std::thread> threads;
  for (std::uint64_t thread = 0; thread < kThreadCount; ++thread) {
    threads.emplace_back([&, thread] {
      for (std::uint64_t n = 0; n < kPairs; ++n) {
        together.arrive_and_wait();
        add_pair(t, TestKey{n % kKeys}, n * kThreadCount + thread);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(full_, 0u);
  std::vector<std::uint64_t> seen;
  for (std::uint32_t at = 0; at < t.size; ++at) {
    std::uint64_t* row = t.row(at);
    if (*row == kFree) continue;
    const std::uint64_t number = t.key(row)[0];
    ASSERT_LT(number, kKeys);
    EXPECT_EQ(*row, hash_of(TestKey{number}, kWords) | kPublished);
    for (std::uint32_t k = 0; k < kWords; ++k) EXPECT_EQ(t.key(row)[k], TestKey{number}.word(k));
    EXPECT_EQ(*t.count(row), kThreadCount * ((kPairs - number - 1) / kKeys + 1));
    for (std::uint64_t k = 0; k < kEngineCases; ++k) EXPECT_EQ(t.cases(row)[k], number * kThreadCount + k);
    seen.push_back(number);
  }
  std::sort(seen.begin(), seen.end());
  ASSERT_EQ(seen.size(), kKeys);
  EXPECT_EQ(std::adjacent_find(seen.begin(), seen.end()), seen.end());
}

TEST_F(SignatureTableTest, AFullTableSaysSoAndKeepsWhatItHolds) {
  const SignatureTable t = table(8);
  for (std::uint64_t number = 0; number < 8; ++number) add_pair(t, TestKey{number}, number);
  EXPECT_EQ(full_, 0u);
  const std::vector<std::uint64_t> before = rows_;
  add_pair(t, TestKey{8}, 8);
  EXPECT_EQ(full_, 1u);
  EXPECT_EQ(rows_, before);
  add_pair(t, TestKey{3}, 11);
  std::uint64_t* row = find_row(t, TestKey{3});
  EXPECT_EQ(*t.count(row), 2u);
  EXPECT_EQ(t.cases(row)[1], 11u);
}

TEST_F(SignatureTableTest, KeysThatDifferInTheirLastWordOnlyAreApart) {
  struct LastWord {
    std::uint64_t last;
    std::uint64_t word(std::uint32_t k) const { return k + 1 == kWords ? last : 42; }
  };
  const SignatureTable t = table(64);
  for (std::uint64_t last = 0; last < 40; ++last) add_pair(t, LastWord{last}, last);
  for (std::uint64_t last = 0; last < 40; ++last) {
    std::uint64_t* row = find_row(t, LastWord{last});
    EXPECT_EQ(*t.count(row), 1u);
    EXPECT_EQ(t.cases(row)[0], last);
  }
}

TEST(SignatureHead, EveryHeadComesBackFromItsWord) {
  for (int bucket = -kBucketMost; bucket <= kBucketMost; ++bucket) {
    for (int rest = 0; rest < 4 * 3 * 3 * 2; ++rest) {
      const auto contact = static_cast<Contact>(rest % 4);
      const Relation r{contact == Contact::none ? Verdict::disjoint : Verdict::intersects,
                       contact,
                       sign_of(static_cast<Bucket>(bucket)),
                       {rest / 4 % 3, rest / 12 % 3, rest / 36 != 0}};
      const std::uint32_t group = static_cast<std::uint32_t>(rest) * 0x1234567u;
      const auto nesting = static_cast<Nesting>(rest % 5 % 4);
      const SignatureHead back = unpacked(packed(group, packed(r, nesting), static_cast<Bucket>(bucket)));
      EXPECT_EQ(back.nesting, nesting);
      EXPECT_EQ(back.group, group);
      EXPECT_EQ(back.relation, r);
      EXPECT_EQ(back.bucket, bucket);
    }
  }
}

}  // namespace
}  // namespace graze::cuda
