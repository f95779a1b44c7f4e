// SPDX-License-Identifier: Apache-2.0
// Kinds of failure: what a campaign's signatures have in common. A kind is a subject, a cause, the source line of the
// comparison that decides, and whether the pairs are degenerate, coplanar or general. A signature whose lanes are wrong
// for different reasons belongs to several kinds.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "corpus/pair_format.h"
#include "fuzz/campaign/store.h"
#include "fuzz/selected_lanes.h"
#include "oracle/truth.h"

namespace graze::fuzz {

// Why one lane is wrong on a pair.
struct LaneReason {
  const Lane* lane;
  std::string cause;
  std::string line;  // "core/algorithms/moller_1997.h:117"; empty where no comparison is to blame, or none is known
  bool settled;
  bool audited;  // the cause could be checked: what the lane computes is known, or it is foreign code, by experiments
};

// Of the subject's lanes under test that are wrong on the pair. A lane whose run is not known has the reason of its
// source with every operation rounded as written, where that is wrong alike.
std::vector<LaneReason> reasons_of(const SelectedLanes& under_test, std::string_view subject, const Pair& pair,
                                   Verdict truth);

// So many kinds are shown to a person: listed, on cards, with maps. There are hundreds, most of them of a few pairs.
inline constexpr std::size_t kMostShown = 40;

// As a campaign's case says it.
Verdict truth_of(const corpus::Entry& entry);

// The 18 hex floats, as a file of pairs has them.
std::string pair_text(const Pair& pair);

// "degenerate" where a triangle is a segment or a point, or else "coplanar" or "general".
std::string_view shape_name(const Hulls& hulls);

// "moller_1997/rounding/moller_1997.h:117/general"; "-" for a line that is empty.
std::string kind_key(std::string_view subject, const LaneReason& reason, const Hulls& hulls);

// What a kind is, where it was seen, and its pairs:
// {"key", "subject", "cause", "line", "shape", "pairs", "signatures", "lanes": [id], "settled": [yes, of],
//  "strata": {id: kept pairs}, "margins": {bucket: pairs}, "places": [in summary["signatures"]],
//  "simplest": {"case", "pair", "from", "lanes": [id], "verdicts": {id: verdict}, "sentences": [text]},
//  "worst": {"case", "pair", "from", "margin_ulps"}}
// `pairs` are those of its signatures, each told by one pair: what was minimised, or else the first one kept. Of the
// simplest pair all lanes that are wrong are of the kind where there is such a pair; the worst one has the largest
// margin of all kept pairs that are of the kind, of those looked at (kMostLookedAt). Returns: the commonest first,
// equal ones by key. Nothing once `stop`, which is asked now and then, says so. Deterministic, whatever the threads.
// Throws: FormatError; std::runtime_error where a device and its twin differ.
inline constexpr std::size_t kMostLookedAt = 40;
Json find_kinds(
    const SelectedLanes& under_test, const std::filesystem::path& directory, const Json& summary,
    const std::function<bool()>& stop = [] { return false; });

// The kinds in failures.json; null without the file, and where the summary or a case has changed since. They are
// compared with the summary and the cases: all but causes, lines, sentences, and verdicts of lanes of other subjects.
// Throws: FormatError, with the command that writes the file again.
Json read_kinds(const std::filesystem::path& directory);
// The same, or those of the campaign's lanes, found now and stored.   Throws: as find_kinds; UsageError for lanes that
// are none here.
Json kinds_of(
    const std::filesystem::path& directory, const Json& summary,
    const std::function<bool()>& stop = [] { return false; });
void write_kinds(const std::filesystem::path& directory, const SelectedLanes& under_test, const Json& kinds);

// How many of the summary's signatures belong to no kind: their lanes were not looked at, run on a device alone, or are
// foreign code that did not fail again.
std::size_t signatures_without_kind(const Json& summary, const Json& kinds);

}  // namespace graze::fuzz
