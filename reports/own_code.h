// SPDX-License-Identifier: Apache-2.0
// What a campaign says about a person's own code: whether it is right, where it is wrong, which failures to look at
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
// cpu lane, or nvcc's default for a CUDA source, of the first precision.
LaneIndices own_lanes(const CampaignCounts& counts);

// "mine/f32/cpu is wrong on 12 (1.2 %, …) of 1,000 pairs: 10 false positives, 2 false negatives." Without a wrong
// verdict: how much the pairs prove that it decides.
std::string wrong_words(const CampaignCounts& counts, std::size_t lane);

// "By group of strata: general 12 of 500 (2.4 %), coplanar 0 of 500."
std::string wrong_by_kind(const CampaignCounts& counts, std::size_t lane);

// The subject's other builds, and on how many pairs their verdicts differ from the cpu lane's; empty without other
// builds.
std::string other_builds(const CampaignCounts& counts, std::size_t lane);

// The kinds of failure (fuzz/minimise/kinds.h) of the lane's subject that matter most, at most `most`. First those of
// this lane, then those of other builds alone. Among them first those without an answer (crash, time-out, changing
// verdict), then those of triangles that are no segments or points, and among these the mistakes of the code itself, if
// they are at least 1 % of all, before rounding and before causes that are not settled. Equals: the commonest first.
// kinds: may be null.
std::vector<nlohmann::ordered_json> first_kinds(const nlohmann::ordered_json& kinds, const ReportLane& lane,
                                                std::size_t most);

// What happens on the kind's simplest pair: "It says disjoint, but …" if the lane is wrong there; of other lanes alone
// with their names.
std::string kind_sentence(const nlohmann::ordered_json& kind, const std::string& lane);

// A kind's cause and line, with "perhaps" where the sentence says that the cause is not settled: "perhaps logic at
// mine.cpp:14".
std::string cause_words(const nlohmann::ordered_json& kind);

// The errors of a kind's pairs: "all false negatives", "10 false positives, 2 false negatives". Empty where the code
// gives no verdict or changes it.
std::string errors_words(const nlohmann::ordered_json& kind);

// A kind in words: "812 coplanar pairs (66 %), all false negatives: logic".   failures: wrong_pairs of the subject.
std::string kind_title(const nlohmann::ordered_json& kind, std::uint64_t failures);

// What the list of the first kinds is: of how many, in which order, what the shares are of, and that one pair of each
// signature was looked at.   told, kinds: numbers of kinds of the subject; failures: its wrong_pairs.
std::string kinds_heading(const CampaignCounts& counts, std::size_t lane, std::size_t told, std::size_t kinds,
                          std::uint64_t failures);

// The number of pairs on which some lane of the subject is wrong.   summary: of the campaign.
std::uint64_t wrong_pairs(const nlohmann::ordered_json& summary, std::string_view subject);

// The pair that failures.json stores as 18 hex floats.
AnyPair pair_of_kind(const nlohmann::ordered_json& kind);

// The 18 coordinates as the shortest decimals that give the same bits. `graze check` reads them.
std::string pair_on_a_line(const AnyPair& pair);

// What a negligible number in place of the epsilon does to the campaign's pairs.
struct EpsilonEffect {
  std::string named;                     // "1e-6f at mine.cpp:9"
  std::uint64_t mended = 0, broken = 0;  // wrong pairs that become right, and right ones that become wrong
};

// Whether failures of the lane show an absolute epsilon, and from which margin on the lane is right. With an effect,
// what it counts, in place of what the kinds say. in_source: the epsilon of its source, "1e-6f at mine.cpp:9"; empty if
// none is known.
std::string epsilon_words(const CampaignCounts& counts, std::size_t lane, const nlohmann::ordered_json& kinds,
                          const std::string& in_source = "", const std::optional<EpsilonEffect>& effect = {});

// The sentences of a report about all own subjects: right or not, where, the first case, the epsilon. Empty for a
// campaign of published lanes.   kinds: null if they are not known.
std::vector<std::string> own_code_answer(const CampaignCounts& counts, const nlohmann::ordered_json& kinds);

// A failure as a paragraph of a screen.
struct ScreenFailure {
  std::string title, pair, sentence;
};

// Lays the paragraphs out. Sentences of failures are cut to keep to `most` lines: each gets a line, then each in turn
// another one while there is room.
std::string one_screen(const std::vector<std::string>& before, const std::vector<ScreenFailure>& failures,
                       const std::vector<std::string>& after, const Screen& screen, int most);

}  // namespace graze::reports
