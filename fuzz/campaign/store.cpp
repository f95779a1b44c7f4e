// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/store.h"

#include <algorithm>

#include "core/cannot.h"
#include "core/margin/axis.h"
#include "fuzz/counts_json.h"

namespace graze::fuzz {
namespace {

// Rows are merged up to this many pairs, which keeps the database of a long campaign small. Judging a damaged row's
// pairs again takes a minute or two. A batch from a GPU engine is larger, and has its own row.
constexpr std::uint64_t kRowPairs = std::uint64_t{1} << 24;

const std::filesystem::path& with_folders(const StoreSpec& spec) {
  const std::filesystem::path& directory = spec.directory;
  std::error_code error;
  std::filesystem::create_directories(spec.shard.whole() ? directory / "cases" : directory, error);
  if (error) throw std::runtime_error(cannot("make the directory", directory, error.message()));
  if (std::filesystem::is_symlink(std::filesystem::symlink_status(directory / "cases")))
    throw std::runtime_error(cannot("use", directory / "cases", "it is a link to another folder; remove it"));
  return directory;
}

// Whether the lane belongs to foreign code, either opened here or only recorded.
bool is_foreign(const StoreSpec& spec, const std::string& id) {
  if (const Lane* lane = find_lane(id)) return lane->foreign;
  const Json subjects = spec.spec.value("subjects", Json::array());
  return std::any_of(subjects.begin(), subjects.end(),
                     [&](const Json& row) { return id.starts_with(row.at("name").get<std::string>() + '/'); });
}

bool is_in_float32(const std::string& id) {
  const std::optional<LaneName> lane = parse_lane_name(id);
  return lane && lane->scalar == name(Scalar::f32);
}

Json source_results(const strata::PairSource& source, const StoreSpec& spec, const StoredCounts& counts) {
  const std::vector<std::string>& lanes = spec.lanes;
  std::uint64_t pairs = 0, intersects = 0;
  std::vector<analysis::LaneCounts> of_lane(lanes.size());
  Json margins = Json::object(), extremes = Json::object();
  for (int b = -kBucketMost; b <= kBucketMost; ++b) {
    const auto bucket = static_cast<Bucket>(b);
    const auto add = [&](const analysis::Tally& tally, const std::string& name, Json& rows) {
      if (tally.pairs(bucket) == 0) return;
      Json& row = rows[name] = {
          {"pairs", tally.pairs(bucket)}, {"wrong", Json::object()}, {"differs_from_cpu", Json::object()}};
      for (std::size_t l = 0; l < lanes.size(); ++l) {
        const analysis::LaneCounts& lane = tally.lane(static_cast<int>(l), bucket);
        if (lane.wrong() > 0) row["wrong"][lanes[l]] = lane.wrong();
        if (lane.differs_from_cpu > 0) row["differs_from_cpu"][lanes[l]] = lane.differs_from_cpu;
      }
    };
    add(counts.tally, name_of_bucket(bucket), margins);
    if (source.axis != Axis::none) add(counts.extremes, std::to_string(exponent_of(source.axis, bucket)), extremes);
    pairs += counts.tally.pairs(bucket);
    intersects += counts.tally.intersects(bucket);
    for (std::size_t l = 0; l < lanes.size(); ++l) of_lane[l] += counts.tally.lane(static_cast<int>(l), bucket);
  }
  Json row = {{"pairs", pairs}, {"intersects", intersects}, {"lanes", Json::object()}, {"margins", margins}};
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    Json& of = row["lanes"][lanes[l]] = counts_json(of_lane[l], is_foreign(spec, lanes[l]));
    of["differs_from_cpu"] = of_lane[l].differs_from_cpu;
    if (strata::stratum_in_doubles(source.id) && is_in_float32(lanes[l])) of["stored"] = of_lane[l].stored;
  }
  if (source.axis != Axis::none) row["extremes"][std::string(name(source.axis))] = extremes;
  return row;
}

}  // namespace

Store::Store(StoreSpec spec)
    : spec_(std::move(spec)),
      lock_(with_folders(spec_), FolderLock::WhenTaken::refuse),
      file_(spec_),
      rows_(spec_.sources.size()),
      of_source_(spec_.sources.size(), StoredCounts(static_cast<int>(spec_.lanes.size()))) {
  file_.for_each([&](std::int64_t id, const PairRange& range, const StoredCounts& counts) {
    rows_[static_cast<std::size_t>(range.source)][range.first] = {id, range.pairs};
    add(range, counts);
  });
}

void Store::add(const PairRange& range, const StoredCounts& counts) {
  of_source_[static_cast<std::size_t>(range.source)].PairCounts::add(counts);
  for (const auto& [key, found] : counts.signatures) signatures_[key].add(found);
  for (const auto& [lane, found] : counts.executor_mismatches) executor_mismatches_[lane].add(found);
}

std::uint64_t Store::done(int source) const {
  std::uint64_t pairs = 0;
  for (const auto& [first, row] : rows_[static_cast<std::size_t>(source)]) pairs += row.pairs;
  return pairs;
}

std::vector<PairRange> Store::gaps(int source) const {
  const PairRange share = share_of(spec_.shard, source, spec_.sources[static_cast<std::size_t>(source)].pairs);
  std::vector<PairRange> found;
  std::uint64_t begin = share.first;
  for (const auto& [first, row] : rows_[static_cast<std::size_t>(source)]) {
    if (first > begin) found.push_back({source, begin, first - begin});
    begin = first + row.pairs;
  }
  if (begin < share.first + share.pairs) found.push_back({source, begin, share.first + share.pairs - begin});
  return found;
}

PairRange Store::missing(int source, std::uint64_t most) const {
  const std::vector<PairRange> all = gaps(source);
  return all.empty() ? PairRange{source, 0, 0} : PairRange{source, all[0].first, std::min(most, all[0].pairs)};
}

bool Store::holds(const PairRange& range) const {
  const auto& rows = rows_[static_cast<std::size_t>(range.source)];
  const auto next = rows.upper_bound(range.first);
  return next != rows.begin() && std::prev(next)->first + std::prev(next)->second.pairs >= range.first + range.pairs;
}

void Store::commit(const PairRange& range, const StoredCounts& fresh) {
  auto& rows = rows_[static_cast<std::size_t>(range.source)];
  StoredCounts counts = fresh;
  PairRange row = range;
  std::vector<std::int64_t> replaced;
  const auto next = rows.lower_bound(range.first);
  auto first = next;
  while (first != rows.begin()) {
    const auto& [begin, before] = *std::prev(first);
    if (begin + before.pairs != row.first || before.pairs > row.pairs || before.pairs + row.pairs > kRowPairs) break;
    --first;
    counts.add(file_.counts(before.id));
    replaced.push_back(before.id);
    row.first = begin;
    row.pairs += before.pairs;
  }
  const std::int64_t id = file_.put(row, counts, replaced);
  rows.erase(first, next);
  rows[row.first] = {id, row.pairs};
  add(range, fresh);
}

// Replaces all rows of the source with one row for its whole share: the sum of their counts and `counts`.
void Store::put_whole(int source, StoredCounts counts) {
  auto& rows = rows_[static_cast<std::size_t>(source)];
  const PairRange all = share_of(spec_.shard, source, spec_.sources[static_cast<std::size_t>(source)].pairs);
  std::vector<std::int64_t> replaced;
  for (const auto& [first, row] : rows) {
    counts.add(file_.counts(row.id));
    replaced.push_back(row.id);
  }
  const std::int64_t id = file_.put(all, counts, replaced);
  rows = {{all.first, {id, all.pairs}}};
}

void Store::complete(int source, const StoredCounts& rest) {
  const std::vector<PairRange> missing = gaps(source);
  if (missing.empty()) return;
  put_whole(source, rest);
  add(missing.front(), rest);
}

void Store::compact() {
  for (std::size_t s = 0; s < rows_.size(); ++s) {
    if (rows_[s].size() > 1) put_whole(static_cast<int>(s), StoredCounts(static_cast<int>(spec_.lanes.size())));
  }
  file_.shrink();
}

std::uint64_t Store::disagreements() const {
  std::uint64_t all = 0;
  for (const StoredCounts& source : of_source_) all += source.disagreements;
  return all;
}

Json results_of(const StoreSpec& spec, const std::vector<StoredCounts>& of_source) {
  Json strata = Json::object();
  std::uint64_t disagreements = 0;
  for (std::size_t s = 0; s < spec.sources.size(); ++s) {
    strata[spec.sources[s].id] = source_results(spec.sources[s], spec, of_source[s]);
    disagreements += of_source[s].disagreements;
  }
  return {{"strata", strata}, {"disagreements", disagreements}};
}

Json Store::oracle() const {
  StoredCounts all(0);
  for (const StoredCounts& source : of_source_) {
    all.cgal += source.cgal;
    all.gmp += source.gmp;
    all.exact += source.exact;
  }
  // "apart" is always 0: a campaign stops before it stores anything if two exact decisions differ.
  return {{"cgal", all.cgal}, {"gmp", all.gmp}, {"exact", all.exact}, {"apart", 0}};
}

}  // namespace graze::fuzz
