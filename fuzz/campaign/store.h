// SPDX-License-Identifier: Apache-2.0
// The campaign's store: one SQLite database with one transaction per batch. If the process is killed at any point,
// committed batches remain, and the same campaign resumes from there. Totals are not stored; they are sums over rows
// whose checksums are correct. A changed row is detected, and the pairs of a lost row are judged again.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "fuzz/campaign/store_file.h"
#include "fuzz/files.h"

namespace graze::fuzz {

// {"strata": …, "disagreements": …} from the counts of each source, in a fixed order.
Json results_of(const StoreSpec& spec, const std::vector<StoredCounts>& of_source);

class Store {
 public:
  // Opens or creates the store in the spec's directory. No other process can open it while this object lives.
  // Throws: the errors of StoreFile; std::runtime_error if another process uses the store.
  explicit Store(StoreSpec spec);

  std::uint64_t done(int source) const;

  // The source's first range of missing pairs, cut to at most `most` pairs.
  PairRange missing(int source, std::uint64_t most) const;

  // All of the source's missing pairs within the store's shard.
  std::vector<PairRange> gaps(int source) const;
  // Whether all of these pairs are done.
  bool holds(const PairRange& range) const;

  // Commits these pairs' counts in one transaction.
  // Requires: none of these pairs is committed already.
  void commit(const PairRange& range, const StoredCounts& fresh);

  // Commits all missing pairs of the source in one transaction; `rest` is the sum of their counts. Leaves one row for
  // the source.
  void complete(int source, const StoredCounts& rest);

  // Leaves one row for each source, and shrinks the file.   Requires: no pairs are missing.
  void compact();

  void finish() { file_.finish(); }
  void expect_in_place() const { file_.expect_in_place(); }

  // The number of committed pairs that each exact decision judged.
  Json oracle() const;

  std::uint64_t disagreements() const;

  // The results of all committed pairs; see results_of.
  Json results() const { return results_of(spec_, of_source_); }

  const StoreSpec& spec() const { return spec_; }

  // The committed counts of each source, without signatures and executor_mismatches.
  const std::vector<StoredCounts>& of_source() const { return of_source_; }

  const std::map<std::string, SignatureCount>& signatures() const { return signatures_; }  // by key
  // Pairs on which a device and its twin differ, by lane.
  const std::map<std::string, SignatureCount>& executor_mismatches() const { return executor_mismatches_; }

 private:
  struct Row {
    std::int64_t id;
    std::uint64_t pairs;
  };

  void add(const PairRange& range, const StoredCounts& counts);
  void put_whole(int source, StoredCounts counts);

  StoreSpec spec_;
  FolderLock lock_;
  StoreFile file_;
  std::vector<std::map<std::uint64_t, Row>> rows_;  // of each source, by their first pair
  std::vector<StoredCounts> of_source_;             // without signatures and executor_mismatches
  std::map<std::string, SignatureCount> signatures_, executor_mismatches_;  // of all sources
};

}  // namespace graze::fuzz
