// SPDX-License-Identifier: Apache-2.0
// Describes a campaign's results for a user's own code: whether it is right, where it is wrong, which failures to look
// at first, and whether an epsilon is to blame. `graze try` and the top of a report show these sentences.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/any_pair.h"
#include "reports/counts.h"
#include "reports/lane_words.h"
#include "reports/screen.h"

namespace graze::reports {

// Returns one lane of each subject that is neither exact nor published: the build that its author gets by default. This
// is the cpu lane in the subject's first precision or, for a CUDA source, the lane with nvcc's default flags.
LaneIndices own_lanes(const CampaignCounts& counts);

// "mine/f32/cpu is wrong on 12 (1.2 %, …) of 1,000 pairs: 10 false positives, 2 false negatives." If no verdict
// is wrong, the sentence gives the bound on the error rate that the decided pairs prove.
std::string wrong_words(const CampaignCounts& counts, std::size_t lane);

// "By group of strata: general 12 of 500 (2.4 %), coplanar 0 of 500."
std::string wrong_by_kind(const CampaignCounts& counts, std::size_t lane);

// Counts the pairs on which the subject's other builds are wrong, and those on which their verdicts differ from this
// lane's. Empty if there are no other builds.
std::string other_builds(const CampaignCounts& counts, std::size_t lane);

// Returns the most important kinds of failure (fuzz/minimise/kinds.h) of the lane's subject, at most `most`. The order
// is: kinds without an answer (crash, time-out, changing verdict); settled mistakes of the code itself on at least 1 %
// of its wrong pairs; other kinds on proper triangles; kinds on degenerate triangles; kinds of other builds only. Among
// equally important kinds, the most common comes first.   kinds: may be null.
std::vector<nlohmann::ordered_json> first_kinds(const nlohmann::ordered_json& kinds, const ReportLane& lane,
                                                std::size_t most);

// Describes what happens on the kind's simplest pair. Starts with "It says disjoint, but …" if the lane is wrong there.
// Otherwise names the lanes that are wrong there.
std::string kind_sentence(const nlohmann::ordered_json& kind, const std::string& lane);

// A kind's cause and line, with "perhaps" if the cause is not settled: "perhaps logic at mine.cpp:14".
std::string cause_words(const nlohmann::ordered_json& kind);

// The errors on a kind's pairs: "all false negatives", "10 false positives, 2 false negatives". Empty if the code
// crashes, times out or is unstable.
std::string errors_words(const nlohmann::ordered_json& kind);

// A kind in words: "812 coplanar pairs (66 %), all false negatives: logic".   failures: wrong_pairs of the subject.
std::string kind_title(const nlohmann::ordered_json& kind, std::uint64_t failures);

// The heading of the list of the first kinds: how many kinds are listed, in which order, what the percentages refer to,
// and that one pair of each signature was examined.
// told: the number of listed kinds.   kinds: the number of all kinds of the subject.   failures: its wrong_pairs.
std::string kinds_heading(const CampaignCounts& counts, std::size_t lane, std::size_t told, std::size_t kinds,
                          std::uint64_t failures);

// The number of pairs on which some lane of the subject is wrong.   summary: the campaign's.
std::uint64_t wrong_pairs(const nlohmann::ordered_json& summary, std::string_view subject);

// The kind's simplest pair, which failures.json stores as 18 hex floats.
AnyPair pair_of_kind(const nlohmann::ordered_json& kind);

// The 18 coordinates as the shortest decimals with the same bits. `graze check` reads this form.
std::string pair_on_a_line(const AnyPair& pair);

// The effect of replacing the epsilon by subjects::kNegligible, on the campaign's pairs.
struct EpsilonEffect {
  std::string named, by;                 // "1e-6f at mine.cpp:9"; "1e-36f"
  std::uint64_t mended = 0, broken = 0;  // wrong pairs that are no longer wrong; others that become wrong
};

// Describes whether failures of the lane show an absolute epsilon, and from which margin upwards the lane is right.
// If `effect` is given, gives its counts instead. in_source: the epsilon in the lane's source, such as "1e-6f at
// mine.cpp:9"; empty if none is known.
std::string epsilon_words(const CampaignCounts& counts, std::size_t lane, const nlohmann::ordered_json& kinds,
                          const std::string& in_source = "", const std::optional<EpsilonEffect>& effect = {});

// Returns a report's sentences about each of the user's own subjects: whether it is right, where it errs, the first
// case to look at, and the epsilon. Empty for a campaign of published lanes.   kinds: null if unknown.
std::vector<std::string> own_code_answer(const CampaignCounts& counts, const nlohmann::ordered_json& kinds);

// A failure as a paragraph on the terminal.
struct ScreenFailure {
  std::string title, pair, sentence;
};

// Lays out the paragraphs in at most `most` lines, if possible, by cutting the failures' sentences. Each sentence gets
// one line; while there is room, further lines go to the sentences in turn.
std::string one_screen(const std::vector<std::string>& before, const std::vector<ScreenFailure>& failures,
                       const std::vector<std::string>& after, const Screen& screen, int most);

}  // namespace graze::reports
