// SPDX-License-Identifier: Apache-2.0
// The campaign's store: one SQLite database, one transaction a batch. Kill the process anywhere: what was
// committed stays, and the same campaign goes on from there.
#pragma once

#include <compare>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analysis/signature.h"
#include "analysis/tally.h"
#include "fuzz/campaign/database.h"
#include "strata/pair_source.h"

namespace graze::fuzz {

using Json = nlohmann::ordered_json;

// Cases kept of each signature: those with the smallest keys, whoever finds them first.
inline constexpr std::size_t kKeptCases = 4;

// A pair by its numbers: which source of the campaign, and its index there.
struct CaseKey {
  std::uint64_t index = 0;
  int source = 0;
  auto operator<=>(const CaseKey&) const = default;
};

struct SignatureCount {
  std::uint64_t count = 0;
  std::vector<CaseKey> cases;  // the smallest, sorted, at most kKeptCases

  void add(const CaseKey& found);
  void add(const SignatureCount& other);

 private:
  void keep(const CaseKey& found);
};

// What one batch found; all of it adds.
struct BatchResult {
  explicit BatchResult(const analysis::Tally& empty) : tally(empty), extremes(empty) {}

  analysis::Tally tally;
  analysis::Tally extremes;  // by place_on_axis; empty without an axis
  std::map<analysis::Signature, SignatureCount> signatures;
  std::map<std::string, SignatureCount> executors_apart;  // by lane: device and twin differ
  std::uint64_t disagreements = 0;                        // pairs on which some lane is wrong
  std::uint64_t cgal = 0;                                 // pairs decided by CGAL
  std::uint64_t gmp = 0;                                  // pairs confirmed by GMP
  std::uint64_t device = 0;                               // pairs decided by the exact lane on a device

  void add(const BatchResult& other);
};

class Store {
 public:
  // Opens the campaign in the directory, or begins it.
  // Throws: UsageError when the directory holds another campaign; std::runtime_error for a foreign or damaged file.
  Store(const std::filesystem::path& directory, const Json& spec, const Json& build);

  // How many pairs of the source are done: those with indices below.
  std::uint64_t done(int source) const;

  // One transaction: the next `pairs` pairs of the source are done.
  void commit(int source, std::uint64_t pairs, const BatchResult& result);

  // Of all that is committed: how many pairs each decision saw.
  Json oracle() const;

  // Of all that is committed: {"strata": …, "disagreements": …}, in a fixed order.
  Json results(const std::vector<strata::PairSource>& sources, const std::vector<std::string>& lanes) const;

  std::map<std::string, SignatureCount> signatures() const;  // by key
  // Pairs on which a device and its twin differ, by lane.
  std::map<std::string, SignatureCount> executors_apart() const;
  std::uint64_t signature_count() const;

 private:
  std::map<std::string, SignatureCount> counts_of(std::string_view kind) const;

  Database database_;
};

}  // namespace graze::fuzz
