// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/store.h"

#include <algorithm>

#include "core/margin/axis.h"

namespace graze::fuzz {
namespace {

// Rows grow to so many pairs, which keeps a long campaign's database small; what a damaged row loses is judged again in
// a minute or two. A batch of a device's engine is larger than that, and a row of its own.
constexpr std::uint64_t kRowPairs = std::uint64_t{1} << 24;

const std::filesystem::path& with_folders(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory / "cases", error);
  if (error)
    throw std::runtime_error(directory.string() +
                             ": expected a directory that can be written, found: " + error.message());
  return directory;
}

Json source_results(const strata::PairSource& source, const std::vector<std::string>& lanes,
                    const StoredCounts& counts) {
  std::uint64_t pairs = 0, intersects = 0;
  std::vector<analysis::LaneCounts> of_lane(lanes.size());
  Json margins = Json::object(), extremes = Json::object();
  for (int b = -kBucketMost; b <= kBucketMost; ++b) {
    const auto bucket = static_cast<Bucket>(b);
    const auto add = [&](const analysis::Tally& tally, const std::string& name, Json& rows) {
      if (tally.pairs(bucket) == 0) return;
      Json& row = rows[name] = {{"pairs", tally.pairs(bucket)}, {"wrong", Json::object()}};
      for (std::size_t l = 0; l < lanes.size(); ++l) {
        const analysis::LaneCounts& lane = tally.lane(static_cast<int>(l), bucket);
        if (lane.wrong() > 0) row["wrong"][lanes[l]] = lane.wrong();
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
    Json& of = row["lanes"][lanes[l]] = {{"false_positive", of_lane[l].false_positive},
                                         {"false_negative", of_lane[l].false_negative},
                                         {"declined", of_lane[l].declined},
                                         {"differs_from_cpu", of_lane[l].differs_from_cpu}};
    const Lane* lane = find_lane(lanes[l]);
    if (!lane || !lane->foreign) continue;
    of["crashed"] = of_lane[l].crashed;
    of["timed_out"] = of_lane[l].timed_out;
    of["unstable"] = of_lane[l].unstable;
    of["by_convention"] = of_lane[l].by_convention;
  }
  if (source.axis != Axis::none) row["extremes"][std::string(name(source.axis))] = extremes;
  return row;
}

}  // namespace

Store::Store(StoreSpec spec)
    : spec_(std::move(spec)),
      lock_(with_folders(spec_.directory), FolderLock::WhenTaken::refuse),
      file_(spec_),
      rows_(spec_.sources.size()),
      of_source_(spec_.sources.size(), StoredCounts(static_cast<int>(spec_.lanes.size()))) {
  file_.for_each([&](std::int64_t id, const PairRange& range, const StoredCounts& counts) {
    rows_[static_cast<std::size_t>(range.source)][range.first] = {id, range.pairs};
    add(range, counts);
  });
}

void Store::add(const PairRange& range, const StoredCounts& counts) {
  StoredCounts& total = of_source_[static_cast<std::size_t>(range.source)];
  total.tally.add(counts.tally);
  total.extremes.add(counts.extremes);
  total.disagreements += counts.disagreements;
  total.cgal += counts.cgal;
  total.gmp += counts.gmp;
  total.device += counts.device;
  for (const auto& [key, found] : counts.signatures) signatures_[key].add(found);
  for (const auto& [lane, found] : counts.executors_apart) executors_apart_[lane].add(found);
}

std::uint64_t Store::done(int source) const {
  std::uint64_t pairs = 0;
  for (const auto& [first, row] : rows_[static_cast<std::size_t>(source)]) pairs += row.pairs;
  return pairs;
}

PairRange Store::missing(int source, std::uint64_t most) const {
  std::uint64_t begin = 0, end = spec_.sources[static_cast<std::size_t>(source)].pairs;
  for (const auto& [first, row] : rows_[static_cast<std::size_t>(source)]) {
    if (first > begin) {
      end = first;
      break;
    }
    begin = first + row.pairs;
  }
  return {source, begin, std::min(most, end - begin)};
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

Json Store::results() const {
  Json strata = Json::object();
  std::uint64_t disagreements = 0;
  for (std::size_t s = 0; s < spec_.sources.size(); ++s) {
    strata[spec_.sources[s].id] = source_results(spec_.sources[s], spec_.lanes, of_source_[s]);
    disagreements += of_source_[s].disagreements;
  }
  return {{"strata", strata}, {"disagreements", disagreements}};
}

Json Store::oracle() const {
  StoredCounts all(0);
  for (const StoredCounts& source : of_source_) {
    all.cgal += source.cgal;
    all.gmp += source.gmp;
    all.device += source.device;
  }
  // The last is always 0: a campaign that finds two exact decisions apart stops before it stores anything.
  return {{"cgal", all.cgal}, {"gmp", all.gmp}, {"device", all.device}, {"apart", 0}};
}

}  // namespace graze::fuzz
