// SPDX-License-Identifier: Apache-2.0
// The campaign's store: one SQLite database, one transaction a batch. Kill the process anywhere: what was
// committed stays, and the same campaign goes on from there. Totals are not stored but added up from rows that check:
// a row that has changed is found out, and pairs whose row is lost are judged again.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "fuzz/campaign/store_file.h"
#include "fuzz/files.h"

namespace graze::fuzz {

// {"strata": …, "disagreements": …} of the counts of each source, in a fixed order.
Json results_of(const StoreSpec& spec, const std::vector<StoredCounts>& of_source);

class Store {
 public:
  // Opens the campaign in the directory, or begins it; no other process can while this lives.
  // Throws: as StoreFile; std::runtime_error when another process is at work there.
  explicit Store(StoreSpec spec);

  // How many pairs of the source are done.
  std::uint64_t done(int source) const;

  // The first pairs of the source that are not, at most so many.
  PairRange missing(int source, std::uint64_t most) const;

  // All of them, of what the store is to hold.
  std::vector<PairRange> gaps(int source) const;
  // Whether all of these pairs are done.
  bool holds(const PairRange& range) const;

  // One transaction: these pairs are done.
  // Requires: none of them was.
  void commit(const PairRange& range, const StoredCounts& fresh);

  // One transaction: all that was missing of the source is done, and this is its sum; one row is left of it.
  void complete(int source, const StoredCounts& rest);

  // Leaves one row of each source, and a file without room for more.   Requires: nothing is missing.
  void compact();

  // Of all that is committed: how many pairs each decision saw.
  Json oracle() const;

  // Pairs on which some lane is wrong.
  std::uint64_t disagreements() const;

  // Of all that is committed; see results_of.
  Json results() const { return results_of(spec_, of_source_); }

  const StoreSpec& spec() const { return spec_; }

  // Of all that is committed, but for signatures and executor_mismatches: of each source.
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
  std::vector<StoredCounts> of_source_;             // but for signatures and executor_mismatches
  std::map<std::string, SignatureCount> signatures_, executor_mismatches_;  // of all sources
};

}  // namespace graze::fuzz
