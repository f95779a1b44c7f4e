// SPDX-License-Identifier: Apache-2.0
// Kinds of failure group a campaign's signatures. A kind has a subject, a cause, the source line of the deciding
// comparison, and a shape: degenerate, contained, coplanar or general. A signature whose lanes are wrong for different
// reasons belongs to several kinds.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "analysis/signature.h"
#include "corpus/pair_format.h"
#include "fuzz/campaign/store.h"
#include "fuzz/selected_lanes.h"
#include "oracle/truth.h"

namespace graze::fuzz {

struct LaneReason {
  const Lane* lane;
  std::string cause;
  std::string line;  // "core/algorithms/moller_1997.h:117"; empty if no comparison is to blame, or it is unknown
  bool settled;
  bool audited;  // the cause was checked: the computation is known, or experiments on foreign code decided
};

// Returns the reasons of the subject's lanes under test that are wrong on the pair. If a lane's computation is not
// known, its reason may come from the lane that compiles the same source and rounds every operation as written, if that
// lane is wrong in the same way.
std::vector<LaneReason> reasons_of(const SelectedLanes& under_test, std::string_view subject, const AnyPair& pair,
                                   Verdict truth);

// At most this many kinds are listed, shown on cards, or mapped. A campaign may have hundreds, mostly with few pairs.
inline constexpr std::size_t kMostShown = 40;

// The truth recorded in a campaign's case.
Verdict truth_of(const corpus::Entry& entry);

// The pair's 18 hex floats, in the format of a pair file.
std::string pair_text(const AnyPair& pair);

// "degenerate" if a triangle is a segment or a point; "contained" if the triangles are coplanar and one lies in the
// other; otherwise "coplanar" or "general".
std::string_view shape_name(const Hulls& hulls, Nesting nesting = Nesting::none);
std::string_view shape_name(const analysis::Signature& signature);

// "moller_1997/rounding/moller_1997.h:117/general"; an empty line becomes "-".
std::string kind_key(std::string_view subject, const LaneReason& reason, std::string_view shape);

// Finds the kinds. Each is an object with its definition, its counts and its pairs:
// {"key", "subject", "cause", "line", "shape", "pairs", "intersecting", "signatures", "lanes": [id],
//  "settled": [yes, of], "strata": {id: kept pairs}, "margins": {bucket: pairs}, "places": [in summary["signatures"]],
//  "simplest": {"case", "pair", "from", "lanes": [id], "verdicts": {id: verdict}, "sentences": [text]},
//  "worst": {"case", "pair", "from", "margin_ulps"}}
// `pairs` counts the pairs of its signatures. One pair represents each signature: the minimised pair, or else the first
// kept pair. `intersecting` counts the pairs that intersect; wrong verdicts on them are false negatives. If possible,
// the simplest pair shows the commoner error, and every lane that is wrong on it belongs to the kind. The worst pair
// has the largest margin among the kind's examined kept pairs (at most kMostLookedAt).
// Returns: the kinds, most frequent first, ties by key; nothing once `stop`, which is called from time to time, returns
// true. The result does not depend on the number of threads.
// Throws: FormatError; std::runtime_error if a device and its twin differ.
inline constexpr std::size_t kMostLookedAt = 40;
Json find_kinds(
    const SelectedLanes& under_test, const std::filesystem::path& directory, const Json& summary,
    const std::function<bool()>& stop = [] { return false; });

// Reads the kinds from failures.json; null if the file does not exist, or if the summary or a case has changed since.
// All fields are checked against the summary and the cases, except for causes, lines, sentences, and the verdicts of
// other subjects' lanes.
// Throws: FormatError, with the command that writes the file again.
Json read_kinds(const std::filesystem::path& directory);
// Reads the kinds; if there are none, finds and stores the kinds of the campaign's lanes.
// Throws: the errors of find_kinds; UsageError for lanes that this build does not have.
Json kinds_of(
    const std::filesystem::path& directory, const Json& summary,
    const std::function<bool()>& stop = [] { return false; });
void write_kinds(const std::filesystem::path& directory, const SelectedLanes& under_test, const Json& kinds);

// The number of the summary's signatures that belong to no kind, because their lanes were not examined, run only on a
// device, or are foreign code that did not fail again.
std::size_t signatures_without_kind(const Json& summary, const Json& kinds);

}  // namespace graze::fuzz
