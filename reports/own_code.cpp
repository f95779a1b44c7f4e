// SPDX-License-Identifier: Apache-2.0
#include "reports/own_code.h"

#include <algorithm>
#include <sstream>
#include <tuple>

#include "analysis/signature.h"
#include "corpus/pair_format.h"
#include "reports/tables.h"
#include "reports/terminal.h"
#include "subjects/rebuilt.h"

namespace graze::reports {

using Json = nlohmann::ordered_json;
namespace {

// "1 false positive", "34 false negatives", "3 crashed"
std::string errors_in_words(const analysis::LaneCounts& found) {
  std::vector<std::string> parts;
  if (found.false_positive > 0) parts.push_back(counted(found.false_positive, "false positive"));
  if (found.false_negative > 0) parts.push_back(counted(found.false_negative, "false negative"));
  for (const auto& [count, what] : {std::pair(found.crashed, "crashed"), std::pair(found.timed_out, "timed out"),
                                    std::pair(found.unstable, "unstable")}) {
    if (count > 0) parts.push_back(grouped(count) + ' ' + what);
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string not_counted(const analysis::LaneCounts& found) {
  std::string text;
  if (found.declined > 0)
    text += fmt::format(" It declines {}{}.", counted(found.declined, "pair"),
                        found.by_convention > 0 ? " that its convention covers" : "");
  if (found.by_convention > 0)
    text += fmt::format(" It differs or declines on {} for which its convention promises nothing.",
                        counted(found.by_convention, "pair"));
  return text;
}

// Whether the sentence on the kind's simplest pair says that the cause is not settled.
bool is_open(const Json& kind) {
  return kind.at("simplest").at("sentences").at(0).get_ref<const std::string&>().find("not settled") !=
         std::string::npos;
}

bool is_of_lane(const Json& kind, const std::string& lane) {
  const Json& lanes = kind.at("lanes");
  return std::find(lanes.begin(), lanes.end(), lane) != lanes.end();
}

bool has_no_verdict(const std::string& cause) {
  return cause == "crash" || cause == "no answer in time" || cause == "unstable";
}

// The rank of a kind; 0 is the most important.   all: the number of pairs of all kinds of the subject.
int rank_of(const Json& kind, const std::string& lane, std::uint64_t all) {
  if (!is_of_lane(kind, lane)) return 4;
  const std::string cause = kind.at("cause"), shape = kind.at("shape");
  if (has_no_verdict(cause)) return 0;
  if (shape == "degenerate") return 3;
  const bool is_mistake = cause == "logic" || cause == "order-dependent" || cause == "absolute epsilon";
  const bool is_common = 100 * kind.at("pairs").get<std::uint64_t>() >= all;
  return is_mistake && is_common && !is_open(kind) ? 1 : 2;
}

// Describes from which margin upwards the lane is wrong on none of these pairs. Declined pairs are not wrong, so
// nothing is said of a lane that declines all, nor of one that its convention excuses.
std::string trusted_from(const StratumCounts& pairs, std::size_t lane, const std::string& which) {
  if (pairs.lanes[lane].declined == pairs.pairs || pairs.lanes[lane].by_convention > 0) return "";
  std::vector<std::string> right, wrong;
  for (const auto& [side, how] : {std::pair(1, "apart"), {-1, "deep"}}) {
    const Threshold from = threshold(pairs, lane, side);
    if (from.found) {
      right.push_back(fmt::format("the {} at least 2^{} ulps {}", grouped(from.above), from.exponent, how));
    } else if (from.largest) {
      wrong.push_back(fmt::format("2^{} ulps {}", *from.largest, how));
    }
  }
  std::string text;
  if (!right.empty())
    text += fmt::format(" Among {} it is wrong on none of {}.", which, fmt::join(right, " and none of "));
  if (!wrong.empty()) text += fmt::format(" It is wrong on some that are {}.", fmt::join(wrong, " and on some "));
  return text;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

}  // namespace

LaneIndices own_lanes(const CampaignCounts& counts) {
  LaneIndices found;
  for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
    const LaneName& lane = counts.lanes[l].name;
    const Lane* row = counts.lanes[l].row;
    if ((row && row->exact) || is_published(lane.subject)) continue;
    const auto same = std::find_if(found.begin(), found.end(),
                                   [&](std::size_t other) { return counts.lanes[other].name.subject == lane.subject; });
    if (same == found.end()) {
      found.push_back(l);
    } else if (counts.lanes[*same].name.scalar == lane.scalar &&
               (lane.variant == name(Variant::cpu) || lane.variant == name(Variant::cuda_fma))) {
      *same = l;
    }
  }
  return found;
}

std::string wrong_words(const CampaignCounts& counts, std::size_t lane) {
  const analysis::LaneCounts& found = counts.total.lanes[lane];
  const std::string &id = counts.lanes[lane].id, pairs = grouped(counts.total.pairs);
  if (found.wrong() == 0) {
    const std::uint64_t decided = counts.total.pairs - found.declined;
    if (decided == 0) return fmt::format("{} decides none of {} pairs.{}", id, pairs, not_counted(found));
    // The pairs that its convention covers are not counted, so nothing can be said of their rate.
    if (found.by_convention > 0)
      return fmt::format("{} is wrong on none of {}.{}", id, counted(counts.total.pairs, "pair"), not_counted(found));
    return fmt::format(
        "{} is wrong on none of the {} that it decides: with 95 % confidence it errs on fewer than {} of such pairs.{}",
        id, counted(decided, "pair"), rate_words(bound_of_none(decided), Bound::upper), not_counted(found));
  }
  return fmt::format("{} is wrong on {} of {} pairs: {}.{}", id,
                     with_interval(share_of(found.wrong(), counts.total.pairs)), pairs, errors_in_words(found),
                     not_counted(found));
}

std::string wrong_by_kind(const CampaignCounts& counts, std::size_t lane) {
  std::vector<std::string> parts;
  const auto add = [&](const std::string& id, const StratumCounts& of) {
    const std::uint64_t wrong = of.wrong(lane);
    parts.push_back(fmt::format("{} {} of {}{}", id, grouped(wrong), grouped(of.pairs),
                                wrong == 0 ? "" : fmt::format(" ({})", rate_words(wrong, of.pairs))));
  };
  for (const GroupCounts& group : counts.groups) {
    if (group.id == "mesh") {  // the mesh's own pairs are listed apart from moved pairs
      for (const std::size_t s : group.strata) add(counts.strata[s].id, counts.strata[s]);
    } else {
      add(group.id, group.counts);
    }
  }
  return fmt::format("By group of strata: {}.", fmt::join(parts, ", "));
}

std::string other_builds(const CampaignCounts& counts, std::size_t lane) {
  std::vector<std::string> parts;
  for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
    const LaneName& other = counts.lanes[l].name;
    if (l == lane || other.subject != counts.lanes[lane].name.subject) continue;
    const std::optional<std::uint64_t> apart = differs(counts, counts.total, lane, l);
    parts.push_back(fmt::format("{} wrong on {}{}", other.within_subject(), grouped(counts.total.wrong(l)),
                                apart ? fmt::format(", differs on {}", grouped(*apart)) : ""));
  }
  return parts.empty() ? "" : fmt::format("Other builds: {}.", fmt::join(parts, "; "));
}

std::vector<Json> first_kinds(const Json& kinds, const ReportLane& lane, std::size_t most) {
  std::vector<Json> found;
  for (const Json& kind : kinds) {
    if (kind.at("subject").get_ref<const std::string&>() == lane.name.subject) found.push_back(kind);
  }
  std::uint64_t all = 0;
  for (const Json& kind : found) all += kind.at("pairs").get<std::uint64_t>();
  // The kinds are already sorted by their numbers of pairs.
  std::stable_sort(found.begin(), found.end(),
                   [&](const Json& l, const Json& r) { return rank_of(l, lane.id, all) < rank_of(r, lane.id, all); });
  if (found.size() > most) found.resize(most);
  return found;
}

std::string kind_sentence(const Json& kind, const std::string& lane) {
  constexpr std::string_view kSays = ") says ";
  std::string text = kind.at("simplest").at("sentences").at(0);
  constexpr std::string_view kUnit = " of the largest coordinate";  // left out; the glossary defines ulps that way
  if (const std::size_t unit = text.find(kUnit); unit != text.npos) text.erase(unit, kUnit.size());
  const std::size_t at = text.find(kSays);
  return at == text.npos || !is_of_lane(kind.at("simplest"), lane) ? text : "It " + text.substr(at + 2);
}

std::string cause_words(const Json& kind) {
  const std::string line = kind.at("line");
  return fmt::format("{}{}{}", is_open(kind) ? "perhaps " : "", kind.at("cause").get<std::string>(),
                     line.empty() ? "" : " at " + line);
}

std::string errors_words(const Json& kind) {
  const std::string cause = kind.at("cause");
  if (has_no_verdict(cause)) return "";
  const std::uint64_t pairs = kind.at("pairs"), negative = kind.at("intersecting"), positive = pairs - negative;
  if (pairs == 1) return negative == 0 ? "a false positive" : "a false negative";
  if (negative == 0) return "all false positives";
  if (positive == 0) return "all false negatives";
  return errors_in_words({positive, negative});
}

std::string kind_title(const Json& kind, std::uint64_t failures) {
  const std::uint64_t pairs = kind.at("pairs");
  const std::string shape = kind.at("shape"), errors = errors_words(kind);
  return fmt::format("{} ({} %){}: {}", counted(pairs, (shape + " pair").c_str()), bare_percent(pairs, failures),
                     errors.empty() ? "" : ", " + errors, cause_words(kind));
}

std::string kinds_heading(const CampaignCounts& counts, std::size_t lane, std::size_t told, std::size_t kinds,
                          std::uint64_t failures) {
  const std::string& subject = counts.lanes[lane].name.subject;
  const auto builds = std::count_if(counts.lanes.begin(), counts.lanes.end(),
                                    [&](const ReportLane& other) { return other.name.subject == subject; });
  return fmt::format(
      "{} of {} of failure; the code's own mistakes of at least 1 % come first (of the {} that {} gets wrong; one pair "
      "per signature examined):",
      told, counted(kinds, "kind"), counted(failures, "pair"), builds > 1 ? "some build" : "it");
}

std::uint64_t wrong_pairs(const Json& summary, std::string_view subject) {
  std::uint64_t sum = 0;
  for (const Json& row : summary.at("signatures")) {
    if (analysis::subject_of(row.at("key").get<std::string>()) == subject) sum += row.at("count").get<std::uint64_t>();
  }
  return sum;
}

AnyPair pair_of_kind(const Json& kind) {
  std::istringstream in(kind.at("simplest").at("pair").get<std::string>());
  return corpus::pair_of(corpus::PairReader(in, "failures.json", PairTypes::both).next().value());
}

std::string pair_on_a_line(const AnyPair& pair) {
  std::string text;
  for (int c = 0; c < kCoordinates; ++c) {
    text += c == 0 ? "" : c == 9 ? "   " : c % 3 == 0 ? "  " : " ";
    text += visit(pair, [c](const auto& own) { return fmt::format("{}", coordinates(own)[c]); });
  }
  return text;
}

std::string epsilon_words(const CampaignCounts& counts, std::size_t lane, const Json& kinds,
                          const std::string& in_source, const std::optional<EpsilonEffect>& effect) {
  if (effect)
    return fmt::format("Epsilon: with {} in place of {}, {} of the {} are no longer wrong, and {} others become wrong.",
                       effect->by, effect->named, grouped(effect->mended),
                       counted(counts.total.wrong(lane), "wrong pair"), grouped(effect->broken));
  std::uint64_t pairs = 0, settled = 0, of = 0;
  for (const Json& kind : kinds) {
    if (!is_of_lane(kind, counts.lanes[lane].id) ||
        kind.at("cause").get_ref<const std::string&>() != "absolute epsilon")
      continue;
    pairs += kind.at("pairs").get<std::uint64_t>();
    settled += kind.at("settled").at(0).get<std::uint64_t>();
    of += kind.at("settled").at(1).get<std::uint64_t>();
  }
  std::string text = "Epsilon: no failure that was examined shows an absolute epsilon";
  if (pairs > 0) {
    text = fmt::format(
        "Epsilon: on {}, judging by one pair of each signature, an absolute epsilon or another fixed number {}",
        counted(pairs, "wrong pair"),
        settled == 0   ? "perhaps decides"
        : settled < of ? "decides, on some of them perhaps"
                       : "decides");
  }
  if (!in_source.empty()) text += fmt::format(" ({} your {})", pairs > 0 ? "perhaps" : "such as", in_source);
  // With triangles of other sizes, the code fails at other distances, so no margin is named.
  if (settled > 0) return text + "; make it relative to the triangles' size.";
  std::string trusted;
  for (const auto& [id, which] : {std::pair("general", "the pairs of the group general"),
                                  {"general/f64", "the pairs of doubles of the group general"}}) {
    if (const GroupCounts* group = counts.group(id)) trusted += trusted_from(group->counts, lane, which);
  }
  return text + '.' + (trusted.empty() ? trusted_from(counts.total, lane, "all pairs") : trusted);
}

std::vector<std::string> own_code_answer(const CampaignCounts& counts, const Json& kinds) {
  std::vector<std::string> said;
  for (const std::size_t lane : own_lanes(counts)) {
    said.push_back(wrong_words(counts, lane));
    if (counts.total.wrong(lane) == 0) continue;
    said.push_back(wrong_by_kind(counts, lane));
    const std::vector<Json> first = first_kinds(kinds, counts.lanes[lane], 1);
    if (first.empty()) continue;
    const Json& simplest = first[0].at("simplest");
    said.push_back(fmt::format("First look at {}: {}", simplest.at("case").get<std::string>(),
                               simplest.at("sentences").at(0).get<std::string>()));
    said.push_back(epsilon_words(counts, lane, kinds));
  }
  return said;
}

std::string one_screen(const std::vector<std::string>& before, const std::vector<ScreenFailure>& failures,
                       const std::vector<std::string>& after, const Screen& screen, int most) {
  constexpr std::size_t kMostOfSentence = 4;
  const auto paragraphs = [&](const std::vector<std::string>& texts) {
    std::string text;
    for (const std::string& paragraph : texts) text += wrapped(paragraph, screen.columns, 0, 2);
    return text;
  };
  std::vector<std::string> heads;
  std::vector<std::vector<std::string>> sentences;
  for (std::size_t f = 0; f < failures.size(); ++f) {
    heads.push_back(bold(screen, wrapped(fmt::format("{}. {}", f + 1, failures[f].title), screen.columns, 0, 3)) +
                    wrapped(failures[f].pair, screen.columns, 3, 3));
    sentences.push_back(lines_of(wrapped(failures[f].sentence, screen.columns - 2, 3, 3)));
  }
  std::vector<std::size_t> kept(failures.size(), 1);
  const auto text = [&] {
    std::string all = paragraphs(before);
    for (std::size_t f = 0; f < failures.size(); ++f) {
      all += heads[f];
      for (std::size_t l = 0; l < std::min(kept[f], sentences[f].size()); ++l)
        all += sentences[f][l] + (l + 1 == kept[f] && kept[f] < sentences[f].size() ? " …\n" : "\n");
    }
    return all + paragraphs(after);
  };
  const std::string least = text();
  auto left = most - std::count(least.begin(), least.end(), '\n');
  for (std::size_t lines = 2; lines <= kMostOfSentence; ++lines) {
    for (std::size_t f = 0; f < failures.size() && left > 0; ++f) {
      if (sentences[f].size() < lines) continue;
      kept[f] = lines;
      --left;
    }
  }
  return text();
}

}  // namespace graze::reports
