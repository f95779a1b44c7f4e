// SPDX-License-Identifier: Apache-2.0
// What a campaign says about a user's own code: whether it is right, where it is wrong, which failures to look at
// first, and whether an epsilon is to blame. `graze try` and the first screen of a report say this.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/any_pair.h"
#include "reports/counts.h"
#include "reports/lane_words.h"
#include "reports/screen.h"

namespace graze::reports {

// One lane of each subject that is neither exact nor published: the build that its author gets by default. That is the
// cpu lane in the first precision, or for a CUDA source the lane of nvcc's default.
LaneIndices own_lanes(const CampaignCounts& counts);

// "mine/f32/cpu is wrong on 12 (1.2 %, …) of 1,000 pairs: 10 false positives, 2 false negatives." Without a wrong
// verdict: the bound on its error rate that the decided pairs prove.
std::string wrong_words(const CampaignCounts& counts, std::size_t lane);

// "By group of strata: general 12 of 500 (2.4 %), coplanar 0 of 500."
std::string wrong_by_kind(const CampaignCounts& counts, std::size_t lane);

// The subject's other builds, and on how many pairs their verdicts differ from this lane's; empty if there are no other
// builds.
std::string other_builds(const CampaignCounts& counts, std::size_t lane);

// The kinds of failure (fuzz/minimise/kinds.h) of the lane's subject that matter most, at most `most` of them, in this
// order: those without an answer (crash, time-out, changing verdict); mistakes of the code itself that are settled and
// at least 1 % of all; others on triangles that are not segments or points; those on segments and points; and those of
// other builds only. Within each of these steps the most common come first.
// kinds: may be null.
std::vector<nlohmann::ordered_json> first_kinds(const nlohmann::ordered_json& kinds, const ReportLane& lane,
                                                std::size_t most);

// What happens on the kind's simplest pair: "It says disjoint, but …" if the lane is wrong there; otherwise the
// sentence names the lanes that are.
std::string kind_sentence(const nlohmann::ordered_json& kind, const std::string& lane);

// A kind's cause and line, with "perhaps" if the cause is not settled: "perhaps logic at mine.cpp:14".
std::string cause_words(const nlohmann::ordered_json& kind);

// The errors on a kind's pairs: "all false negatives", "10 false positives, 2 false negatives". Empty if the code gives
// no verdict there or changes it.
std::string errors_words(const nlohmann::ordered_json& kind);

// A kind in words: "812 coplanar pairs (66 %), all false negatives: logic".   failures: wrong_pairs of the subject.
std::string kind_title(const nlohmann::ordered_json& kind, std::uint64_t failures);

// The heading of the list of first kinds: how many there are, in which order, what the percentages refer to, and that
// one pair of each signature was examined.   told, kinds: numbers of kinds of the subject; failures: its wrong_pairs.
std::string kinds_heading(const CampaignCounts& counts, std::size_t lane, std::size_t told, std::size_t kinds,
                          std::uint64_t failures);

// The number of pairs on which some lane of the subject is wrong.   summary: the campaign's.
std::uint64_t wrong_pairs(const nlohmann::ordered_json& summary, std::string_view subject);

// The pair that failures.json stores as 18 hex floats.
AnyPair pair_of_kind(const nlohmann::ordered_json& kind);

// The 18 coordinates as the shortest decimals that give the same bits, as `graze check` reads them.
std::string pair_on_a_line(const AnyPair& pair);

// The effect of subjects::kNegligible in place of the epsilon on the campaign's pairs.
struct EpsilonEffect {
  std::string named;                     // "1e-6f at mine.cpp:9"
  std::uint64_t mended = 0, broken = 0;  // wrong pairs that become right, and right ones that become wrong
};

// Whether failures of the lane show an absolute epsilon, and from which margin upwards the lane is right. The counts of
// an `effect` replace what the kinds say. in_source: the epsilon in the lane's source, "1e-6f at mine.cpp:9"; empty if
// none is known.
std::string epsilon_words(const CampaignCounts& counts, std::size_t lane, const nlohmann::ordered_json& kinds,
                          const std::string& in_source = "", const std::optional<EpsilonEffect>& effect = {});

// A report's sentences about all of the user's own subjects: whether each is right, where it errs, the first case, the
// epsilon. Empty for a campaign of published lanes.   kinds: null if they are not known.
std::vector<std::string> own_code_answer(const CampaignCounts& counts, const nlohmann::ordered_json& kinds);

// A failure as a paragraph on a screen.
struct ScreenFailure {
  std::string title, pair, sentence;
};

// Lays the paragraphs out. To keep to `most` lines, it cuts the sentences of failures: each gets one line, then each in
// turn another while there is room.
std::string one_screen(const std::vector<std::string>& before, const std::vector<ScreenFailure>& failures,
                       const std::vector<std::string>& after, const Screen& screen, int most);

}  // namespace graze::reports
