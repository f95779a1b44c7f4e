// SPDX-License-Identifier: Apache-2.0
// A hash table of signatures with open addressing that many threads use at once, on host and device. All keys of a
// table have the same number of 64-bit words. A row's first word is its state: free, being written by the thread that
// claimed it, or published. A thread that finds a row being written waits, so no thread reads an incomplete key. On a
// device, this wait needs independent thread scheduling (sm_70 and later).
#pragma once

#include <cstdint>

#include "cuda/engine/atomics.h"
#include "cuda/engine/engine.h"

namespace graze::cuda {

struct SignatureTable {
  std::uint64_t* rows;      // a row has row_words() words: state, key, count, the smallest indices
  std::uint32_t size;       // rows; a power of two
  std::uint32_t key_words;  // one word for the shape, then the marks
  std::uint32_t* full;      // becomes 1 when a key finds no free row

  GRAZE_HD std::uint32_t row_words() const { return 1 + key_words + 1 + kEngineCases; }
  GRAZE_HD std::uint64_t* row(std::uint32_t at) const { return rows + std::size_t{at} * row_words(); }
  GRAZE_HD const std::uint64_t* key(const std::uint64_t* row) const { return row + 1; }
  GRAZE_HD std::uint64_t* count(std::uint64_t* row) const { return row + 1 + key_words; }
  GRAZE_HD std::uint64_t* cases(std::uint64_t* row) const { return row + 2 + key_words; }
};

// A row's state is kFree, or the hash of its key with kBeingWritten or kPublished in the two lowest bits.
inline constexpr std::uint64_t kFree = 0, kBeingWritten = 1, kPublished = 3, kStateBits = 3;
inline constexpr std::uint64_t kNoCase = ~std::uint64_t{0};

// The hash of a key that has `words` words; key.word(k) is word k. The two lowest bits of the hash are zero.
template <class Key>
GRAZE_HD std::uint64_t hash_of(const Key& key, std::uint32_t words) {
  std::uint64_t hash = 0;
  for (std::uint32_t k = 0; k < words; ++k) {
    hash = (hash ^ key.word(k)) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 32;
  }
  return hash & ~kStateBits;
}

template <class Key>
GRAZE_HD bool holds(const SignatureTable& table, const std::uint64_t* row, const Key& key) {
  for (std::uint32_t k = 0; k < table.key_words; ++k) {
    if (load_relaxed(table.key(row) + k) != key.word(k)) return false;
  }
  return true;
}

// The row of the key. Claims a free row if the key has no row.   Returns: null if no row is free.
template <class Key>
GRAZE_HD std::uint64_t* find_row(const SignatureTable& table, const Key& key) {
  const std::uint64_t hash = hash_of(key, table.key_words);
  std::uint32_t at = static_cast<std::uint32_t>(hash >> 32) & (table.size - 1);
  for (std::uint32_t tried = 0; tried < table.size; ++tried, at = (at + 1) & (table.size - 1)) {
    std::uint64_t* row = table.row(at);
    std::uint64_t state = load_published(row);
    if (state == kFree) {
      if (replace(row, kFree, hash | kBeingWritten)) {
        for (std::uint32_t k = 0; k < table.key_words; ++k) row[1 + k] = key.word(k);
        publish(row, hash | kPublished);
        return row;
      }
      state = load_published(row);
    }
    while (state == (hash | kBeingWritten)) state = load_published(row);
    if (state == (hash | kPublished) && holds(table, row, key)) return row;
  }
  return nullptr;
}

// Stores the index if it is among the row's kEngineCases smallest.
GRAZE_HD inline void keep(const SignatureTable& table, std::uint64_t* row, std::uint64_t index) {
  std::uint64_t* cases = table.cases(row);
  if (index >= load_relaxed(&cases[kEngineCases - 1])) return;
  // The larger index moves to the next place, so the places receive the smallest indices in ascending order.
  for (int k = 0; k < kEngineCases; ++k) {
    const std::uint64_t old = lower_to(&cases[k], index);
    index = old > index ? old : index;
  }
}

template <class Key>
GRAZE_HD void add_pair(const SignatureTable& table, const Key& key, std::uint64_t index) {
  std::uint64_t* row = find_row(table, key);
  if (!row) {
    *table.full = 1;
    return;
  }
  add(table.count(row), 1);
  keep(table, row, index);
}

}  // namespace graze::cuda
