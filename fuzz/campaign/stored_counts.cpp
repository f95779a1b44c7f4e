// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/stored_counts.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "analysis/signature.h"
#include "core/fnv1a.h"
#include "core/lanes/lanes.h"

namespace graze::fuzz {
namespace {

using Json = nlohmann::ordered_json;

// [[bucket, pairs, intersects, [[lane, false positive, false negative, declined, differs from cpu], …]], …]. If any of
// the four counts `crashed`, `timed out`, `unstable` and `by convention` is not 0, all four follow. If rounding doubles
// to float32 caused errors, the four counts follow, and then the number of such errors.
Json to_json(const analysis::Tally& tally) {
  Json rows = Json::array();
  for (int b = -kBucketMost; b <= kBucketMost; ++b) {
    const Bucket bucket = static_cast<Bucket>(b);
    if (tally.pairs(bucket) == 0) continue;
    Json lanes = Json::array();
    for (int l = 0; l < tally.lane_count(); ++l) {
      const analysis::LaneCounts& lane = tally.lane(l, bucket);
      if (!lane.any()) continue;
      lanes.push_back({l, lane.false_positive, lane.false_negative, lane.declined, lane.differs_from_cpu});
      if (!lane.any_foreign() && lane.stored == 0) continue;
      for (const std::uint64_t count : {lane.crashed, lane.timed_out, lane.unstable, lane.by_convention})
        lanes.back().push_back(count);
      if (lane.stored > 0) lanes.back().push_back(lane.stored);
    }
    rows.push_back({b, tally.pairs(bucket), tally.intersects(bucket), std::move(lanes)});
  }
  return rows;
}

// [[key, count, [index, …]], …]
Json to_json(const std::map<std::string, SignatureCount>& signatures) {
  Json rows = Json::array();
  for (const auto& [key, found] : signatures) {
    Json cases = Json::array();
    for (const CaseKey& kept : found.cases) cases.push_back(kept.index);
    rows.push_back({key, found.count, std::move(cases)});
  }
  return rows;
}

void expect(bool holds, const char* what) {
  if (!holds) throw Damaged(fmt::format("{} are inconsistent", what));
}

std::uint64_t whole(const Json& value, std::uint64_t most, const char* what) {
  expect(value.is_number_unsigned() && value.get<std::uint64_t>() <= most, what);
  return value.get<std::uint64_t>();
}

const Json& list(const Json& value, std::size_t least, std::size_t most, const char* what) {
  expect(value.is_array() && value.size() >= least && value.size() <= most, what);
  return value;
}

// Returns: the total number of pairs in the tally.
std::uint64_t read_tally(const Json& rows, std::uint64_t pairs, analysis::Tally& tally, const char* what) {
  std::uint64_t left = pairs;
  int last_bucket = -kBucketMost - 1;
  for (const Json& row : list(rows, 0, kBucketCount, what)) {
    list(row, 4, 4, what);
    expect(row[0].is_number_integer(), what);
    const auto b = row[0].get<std::int64_t>();
    expect(b > last_bucket && b <= kBucketMost, what);
    last_bucket = static_cast<int>(b);
    const Bucket bucket = static_cast<Bucket>(b);
    const std::uint64_t here = whole(row[1], left, what), intersects = whole(row[2], here, what);
    left -= here;
    tally.add(bucket, here, intersects);
    int last_lane = -1;
    for (const Json& lane : list(row[3], 0, static_cast<std::size_t>(tally.lane_count()), what)) {
      list(lane, 5, 10, what);
      expect(lane.size() == 5 || lane.size() == 9 || lane.size() == 10, what);
      const int l = static_cast<int>(whole(lane[0], static_cast<std::uint64_t>(tally.lane_count() - 1), what));
      expect(l > last_lane, what);
      last_lane = l;
      const auto more = [&](std::size_t i) { return i < lane.size() ? whole(lane[i], here, what) : 0; };
      const analysis::LaneCounts counts{{whole(lane[1], here - intersects, what), whole(lane[2], intersects, what),
                                         whole(lane[3], here, what), more(5), more(6), more(7), more(8)},
                                        whole(lane[4], here, what),
                                        more(9)};
      expect(counts.not_true() <= here && (lane.size() != 9 || counts.any_foreign()) &&
                 (lane.size() == 10) == (counts.stored > 0) &&
                 counts.stored <= counts.false_positive + counts.false_negative,
             what);
      tally.add(bucket, l, counts);
    }
  }
  return pairs - left;
}

std::map<std::string, SignatureCount> read_signatures(const Json& rows, const PairRange& range, std::uint64_t pairs,
                                                      bool (*is_key)(const std::string&)) {
  constexpr const char* kWhat = "the signatures and the batch's pairs";
  constexpr std::size_t kMost = ~std::size_t{0};
  std::map<std::string, SignatureCount> signatures;
  for (const Json& row : list(rows, 0, kMost, kWhat)) {
    list(row, 3, 3, kWhat);
    expect(row[0].is_string() && is_key(row[0].get_ref<const std::string&>()), kWhat);
    SignatureCount found;
    found.count = whole(row[1], pairs, kWhat);
    for (const Json& index : list(row[2], 1, kKeptCases, kWhat)) {
      const CaseKey kept{whole(index, range.first + range.pairs - 1, kWhat), range.source};
      expect(kept.index >= range.first && (found.cases.empty() || found.cases.back() < kept), kWhat);
      found.cases.push_back(kept);
    }
    expect(found.cases.size() <= found.count, kWhat);
    expect(signatures.emplace(row[0].get<std::string>(), std::move(found)).second, kWhat);
  }
  return signatures;
}

// Signatures and lane names consist of printable ASCII.
bool is_printable(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < 0x7f; });
}

// Returns null if the bytes are not CBOR.
Json parsed(const std::string& bytes) {
  try {
    return Json::from_cbor(bytes, true, false);
  } catch (const Json::exception&) {  // thrown for sizes that exceed memory, even if exceptions are off
    return nullptr;
  }
}

}  // namespace

StoredCounts::StoredCounts(int lanes)
    : CountsBy(analysis::Tally(std::vector<int>(static_cast<std::size_t>(lanes), -1))) {}

StoredCounts::StoredCounts(const BatchResult& result) : CountsBy(static_cast<const PairCounts&>(result)) {
  executor_mismatches = result.executor_mismatches;
  for (const auto& [signature, found] : result.signatures) signatures[analysis::key(signature)].add(found);
}

std::string to_bytes(const StoredCounts& counts) {
  std::string bytes;
  Json::to_cbor(Json::array({to_json(counts.tally),
                             to_json(counts.extremes),
                             to_json(counts.signatures),
                             to_json(counts.executor_mismatches),
                             counts.disagreements,
                             counts.cgal,
                             counts.gmp,
                             counts.exact,
                             {counts.digests.pairs, counts.digests.of_lane}}),
                bytes);
  return bytes;
}

StoredCounts from_bytes(const std::string& bytes, const PairRange& range, std::uint64_t pairs, Axis axis, int lanes) {
  const Json all = parsed(bytes);
  constexpr std::uint64_t kMost = ~std::uint64_t{0};
  list(all, 9, 9, "a batch's parts");
  StoredCounts counts(lanes);
  expect(read_tally(all[0], pairs, counts.tally, "the margins") == pairs, "the margins and the batch's pairs");
  expect(read_tally(all[1], pairs, counts.extremes, "the extremes") == (axis == Axis::none ? 0 : pairs),
         "the extremes and the batch's pairs");
  counts.signatures = read_signatures(
      all[2], range, pairs, [](const std::string& key) { return is_printable(key) && analysis::parse_signature(key); });
  counts.executor_mismatches = read_signatures(
      all[3], range, pairs, [](const std::string& lane) { return is_printable(lane) && parse_lane_name(lane); });
  counts.disagreements = whole(all[4], pairs, "the disagreements and the batch's pairs");
  counts.cgal = whole(all[5], kMost, "the pairs that CGAL decided");
  counts.gmp = whole(all[6], kMost, "the pairs that GMP confirmed");
  constexpr const char* kDigests = "the digests and the batch's pairs";
  list(all[8], 2, 2, kDigests);
  counts.digests.pairs = whole(all[8][0], pairs, kDigests);
  list(all[8][1], counts.digests.of_lane.size(), counts.digests.of_lane.size(), kDigests);
  for (std::size_t l = 0; l < counts.digests.of_lane.size(); ++l)
    counts.digests.of_lane[l] = whole(all[8][1][l], kMost, kDigests);
  counts.exact = whole(all[7], pairs, "the exact lane's pairs and the batch's pairs");
  return counts;
}

std::uint64_t checksum(std::uint64_t campaign, const PairRange& range, const std::string& bytes) {
  return fnv1a(bytes, fnv1a(fmt::format("{:016x} {} {} {} ", campaign, range.source, range.first, range.pairs)));
}

}  // namespace graze::fuzz
