// SPDX-License-Identifier: Apache-2.0
#include "cuda/engine/engine_run.h"

#include <algorithm>
#include <stdexcept>

namespace graze::cuda {
namespace {

EngineSignature signature_of(std::uint64_t* row, const SignatureTable& table, std::span<const LaneGroup> groups) {
  const std::uint64_t* key = table.key(row);
  const SignatureHead head = unpacked(key[0]);
  EngineSignature s;
  s.relation = head.relation;
  s.nesting = head.nesting;
  s.bucket = head.bucket;
  s.lanes = groups[head.group];
  for (std::uint32_t l = 0; l < s.lanes.count; ++l) {
    const std::uint64_t mark = key[1 + l / kMarksOfWord] >> 2 * (l % kMarksOfWord) & 3;
    s.verdicts.push_back(verdict_of(static_cast<Mark>(mark), s.relation.verdict));
  }
  s.count = *table.count(row);
  for (int k = 0; k < kEngineCases && table.cases(row)[k] != kNoCase; ++k) s.cases.push_back(table.cases(row)[k]);
  return s;
}

}  // namespace

std::vector<LaneGroup> lane_groups(std::span<const Lane* const> lanes, bool of_doubles) {
  std::vector<LaneGroup> groups;
  for (std::size_t first = 0, end; first < lanes.size(); first = end) {
    for (end = first; end < lanes.size() && lanes[end]->info == lanes[first]->info;) ++end;
    if (of_doubles || !lanes[first]->exact)
      groups.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end - first)});
  }
  return groups;
}

std::uint32_t key_words(std::span<const LaneGroup> groups) {
  std::uint32_t words = 0;
  for (const LaneGroup& group : groups) words = std::max(words, mark_words(group.count));
  return 1 + words;
}

std::uint64_t run_blocks(const EngineLimits& limits, std::uint64_t first, std::uint64_t count,
                         const std::function<void(int, std::uint64_t, std::uint32_t)>& judge,
                         const std::function<std::uint32_t()>& left) {
  std::uint64_t done = 0;
  for (int b = 0; done < count; ++b) {
    const std::uint64_t pairs = std::min<std::uint64_t>(limits.block_pairs, count - done);
    judge(b, first + done, static_cast<std::uint32_t>(pairs));
    done += pairs;
    if (left() + std::uint64_t{limits.block_pairs} > limits.undecided) break;
  }
  return done;
}

EngineResult result_of(EngineTotals totals, const SignatureTable& table, std::span<const LaneGroup> groups, Axis axis) {
  if (totals.left > totals.undecided.size())
    throw std::runtime_error("the engine left too many pairs to the host; run fewer pairs at once");
  if (totals.full) throw std::runtime_error("the engine found more signatures than its table has rows");
  EngineResult result;
  const auto middle = totals.counts.begin() + static_cast<std::ptrdiff_t>(totals.counts.size() / 2);
  result.counts.assign(totals.counts.begin(), middle);
  if (axis != Axis::none) result.extreme_counts.assign(middle, totals.counts.end() - 1);
  result.disagreements = totals.counts.back();
  result.undecided = std::move(totals.undecided);
  result.undecided.resize(totals.left);
  std::sort(result.undecided.begin(), result.undecided.end());
  std::vector<std::uint64_t*> found;
  for (std::size_t at = 0; at < totals.rows.size(); at += table.row_words()) {
    if (totals.rows[at] != kFree) found.push_back(&totals.rows[at]);
  }
  std::sort(found.begin(), found.end(), [&](const std::uint64_t* l, const std::uint64_t* r) {
    return std::lexicographical_compare(table.key(l), table.key(l) + table.key_words, table.key(r),
                                        table.key(r) + table.key_words);
  });
  for (std::uint64_t* row : found) result.signatures.push_back(signature_of(row, table, groups));
  return result;
}

}  // namespace graze::cuda
