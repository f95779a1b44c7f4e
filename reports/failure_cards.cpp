// SPDX-License-Identifier: Apache-2.0
#include "reports/failure_cards.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "analysis/signature.h"
#include "core/cannot.h"
#include "core/lanes/verdicts.h"
#include "core/text.h"
#include "corpus/pair_format.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/minimise/kinds.h"
#include "fuzz/sealed.h"
#include "reports/plain_figures.h"
#include "reports/snippet.h"
#include "reports/tables.h"
#include "reports/ulp_map_picture.h"
#include "subjects/subjects.h"

namespace graze::reports {

using fuzz::Json;
namespace {

// Throws: std::invalid_argument if the key is not a signature's.
Json signature_row(const CampaignCounts& counts, const Json& found) {
  const std::string key = found.at("key");
  const std::optional<analysis::Signature> parsed = analysis::parse_signature(key);
  if (!parsed) throw std::invalid_argument("expected the key of a signature, found '" + key + "'");
  const analysis::Signature& signature = *parsed;
  std::string marks;
  for (const ReportLane& lane : counts.lanes) {
    if (lane.name.subject == signature.subject) marks += signature.mark_of(lane.name.within_subject());
  }
  Json row = {{"key", key},
              {"algorithm", signature.subject},
              {"count", found.at("count")},
              {"share", to_json(share_of(found.at("count"), counts.total.pairs)).at("share")},
              {"contact", name(signature.contact)},
              {"dimensions", fmt::format("{}{}", signature.hulls.dimension_a, signature.hulls.dimension_b)},
              {"coplanar", signature.hulls.coplanar},
              {"margin", name_of_bucket(signature.bucket)},
              {"marks", marks},
              {"cards", Json::array()}};
  if (signature.nesting != Nesting::none) row["nesting"] = analysis::name(signature.nesting);
  return row;
}

double number_in(const std::filesystem::path& file, const corpus::Entry& entry, std::string_view key) {
  const std::string text = corpus::text_of(entry, key);
  if (const std::optional<double> value = parse_float64(text)) return *value;
  throw corpus::FormatError(
      fmt::format("{}:{}: expected a number in {}, found '{}'", file.string(), entry.line, key, text));
}

Verdict verdict_of(std::string_view word) { return verdict_named(word).value_or(Verdict::declined); }

// The minimiser's verdicts on the pair, for each lane that it ran.
Json verdicts_of(const CampaignCounts& counts, Verdict truth, const Json& stored) {
  Json rows = Json::array();
  for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
    if (!stored.contains(counts.lanes[l].id)) continue;
    const Verdict verdict = verdict_of(stored[counts.lanes[l].id].get<std::string>());
    rows.push_back({{"lane", l}, {"verdict", name(verdict)}, {"wrong", is_wrong(verdict, truth)}});
  }
  return rows;
}

// spec: the campaign's spec, which records how foreign code is opened.
Json commands_of(const corpus::Entry& entry, const std::string& subject, const std::string& from, const Json& spec) {
  std::string foreign;
  for (const Json& row : spec.value("subjects", Json::array())) {
    if (row.at("name") != subject) continue;
    foreign = " --subject " + shell_word(subject + '=' + row.at("what").get<std::string>());
    if (const std::vector<std::string> flags = row.at("flags"); !flags.empty())
      foreign += " --flags=" + shell_word(fmt::format("{}", fmt::join(flags, " ")));
    if (const double timeout = row.at("timeout"); timeout != subjects::Wanted().timeout)
      foreign += fmt::format(" --subject-timeout {}", timeout);
  }
  const std::string lanes = fmt::format("--lanes '{}/*'{}", subject, foreign);
  const std::string file = fmt::format("echo '{}' > case.pairs", fuzz::pair_text(corpus::pair_of(entry)));
  Json rows = Json::array();
  const auto add = [&](const char* label, const std::string& text) {
    rows.push_back({{"label", label}, {"text", text}});
  };
  add("repro", fmt::format("{}; graze repro case.pairs{}", file, foreign));
  add("explain", fmt::format("{}; graze explain case.pairs {}", file, lanes));
  add("map", fmt::format("{}; graze map case.pairs {}", file, lanes));
  if (from.find(':') != std::string::npos) add("minimize", fmt::format("graze minimize {} {}", from, lanes));
  return rows;
}

// Programs that show a lane of the kind on the host and on the device, a program that shows the truth, and an OBJ file.
Json snippets_of(const CampaignCounts& counts, const corpus::Entry& entry, const Json& kind, Verdict truth,
                 const Json& verdicts, const std::string& from) {
  Json rows = Json::array();
  const std::string name = fmt::format(
      "Case {}{}: contact {}, margin {} ({} ulps)", corpus::field(entry, "kind") ? "minimised from " : "", from,
      corpus::text_of(entry, "contact"), corpus::text_of(entry, "margin"), corpus::text_of(entry, "margin_ulps"));
  const auto is_of_kind = [&](const std::string& id) {
    const Json& lanes = kind.at("simplest").at("lanes");
    return std::find(lanes.begin(), lanes.end(), id) != lanes.end();
  };
  const auto add_lane = [&](SnippetKind language) {
    for (const Json& row : verdicts) {
      const ReportLane& lane = counts.lanes[row["lane"].get<std::size_t>()];
      if (!is_of_kind(lane.id) || !lane.row || !shows(language, *lane.row)) continue;
      const SnippetCase found{name, corpus::pair_of(entry), truth, lane.row,
                              verdict_of(row["verdict"].get<std::string>())};
      std::string text = snippet(language, found);
      if (!lane.row->foreign) {
        const std::string source = amalgamated_source(kind.at("subject").get<std::string>());
        if (const std::size_t at = text.find(source); at != text.npos) text.replace(at, source.size(), kSourceMark);
      }
      rows.push_back({{"label", kSnippetKinds[static_cast<int>(language)]}, {"text", text}});
      return;
    }
  };
  add_lane(SnippetKind::cpp);
  add_lane(SnippetKind::cuda);
  for (const SnippetKind language : {SnippetKind::python, SnippetKind::obj}) {
    rows.push_back({{"label", kSnippetKinds[static_cast<int>(language)]},
                    {"text", snippet(language, {name, corpus::pair_of(entry), truth, nullptr, truth})}});
  }
  return rows;
}

// The numbers of cards that lack a part.
struct Lacking {
  std::size_t minimised = 0, mapped = 0, room = 0;
};

// The maps stored with a case; null if there are none or no room for them.
Json maps_of(const std::filesystem::path& case_file, const AnyPair& pair, const std::vector<std::string>& lanes,
             std::size_t& room, Lacking& lacking) {
  const std::filesystem::path file = std::filesystem::path(case_file).replace_extension(".maps.json");
  const std::string directory = case_file.parent_path().parent_path().string();
  Json maps = fuzz::read_sealed(file, "remove it, then run: graze minimize " + path_word(directory));
  if (!is_map_of(maps, pair, lanes)) {
    ++lacking.mapped;
    return nullptr;
  }
  maps.erase("pair");
  const std::size_t size = maps.dump().size();
  if (size > room) {
    ++lacking.room;
    return nullptr;
  }
  room -= size;
  return maps;
}

// The names of the pairs that the campaign kept for a signature, such as "near_edge_edge:1:42".
Json kept_pairs(const std::filesystem::path& directory, const Json& spec, const Json& found) {
  Json names = Json::array();
  for (const corpus::Entry& entry : fuzz::read_cases(directory, spec, found)) {
    if (!corpus::field(entry, "kind")) names.push_back(corpus::origin_of(entry));
  }
  return names;
}

Json card_of(const std::filesystem::path& directory, const CampaignCounts& counts, const Json& spec, const Json& kind,
             std::size_t& room, Lacking& lacking) {
  const Json& simplest = kind.at("simplest");
  const std::string subject = kind.at("subject");
  const std::filesystem::path file = fuzz::case_file(directory, simplest);
  const std::vector<corpus::Entry> entries = corpus::read_pairs(file, PairTypes::both);
  if (entries.empty() || fuzz::pair_text(corpus::pair_of(entries.front())) != simplest.at("pair").get<std::string>())
    throw corpus::FormatError(
        cannot("use", file, "its first pair is not that of failures.json; run `graze minimize` again"));
  const corpus::Entry& entry = entries.front();
  const AnyPair pair = corpus::pair_of(entry);
  const Verdict truth = verdict_of(corpus::text_of(entry, "truth"));
  const bool minimised = corpus::field(entry, "kind") != nullptr;
  lacking.minimised += !minimised;
  const std::string from = corpus::origin_of(entry);
  const Json verdicts = verdicts_of(counts, truth, simplest.at("verdicts"));
  std::vector<std::string> lanes;
  for (const ReportLane& lane : counts.lanes) {
    if (lane.name.subject == subject) lanes.push_back(lane.id);
  }
  Json card = {{"file", simplest.at("case")}};
  for (const char* field : {"key", "subject", "cause", "line", "shape", "pairs", "intersecting", "signatures", "lanes",
                            "settled", "strata", "margins", "worst"})
    card["kind"][field] = kind.at(field);
  card.update({{"minimised", minimised},
               {"from", from},
               {"coordinates", name(pair.floats ? Scalar::f32 : Scalar::f64)},
               {"pair", coordinates_of(pair)},
               {"truth",
                {{"verdict", name(truth)},
                 {"contact", corpus::text_of(entry, "contact")},
                 {"margin", number_in(file, entry, "margin")},
                 {"margin_ulps", number_in(file, entry, "margin_ulps")}}},
               {"drawing", drawing_of(pair)},
               {"verdicts", verdicts},
               {"sentences", simplest.at("sentences")},
               {"maps", maps_of(file, pair, lanes, room, lacking)},
               {"commands", commands_of(entry, subject, from, spec)},
               {"snippets", snippets_of(counts, entry, kind, truth, verdicts, from)}});
  return card;
}

void say_what_is_missing(Json& missing, const Lacking& lacking, std::size_t cards) {
  if (lacking.minimised != 0) {
    missing.push_back(
        fmt::format("{} of {} cards show a pair as it was found: `graze minimize DIR` makes it simpler, and then "
                    "`graze report DIR` shows the simpler one.",
                    lacking.minimised, cards));
  }
  if (lacking.mapped != 0) {
    missing.push_back(
        fmt::format("{} of {} cards have no ulp map: `graze minimize DIR` stores it.", lacking.mapped, cards));
  }
  if (lacking.room != 0) {
    missing.push_back(
        fmt::format("{} of {} cards show no ulp map, because the file would be too large; `graze map` draws it.",
                    lacking.room, cards));
  }
}

}  // namespace

Json signature_rows(const CampaignCounts& counts, const Json& summary) {
  Json rows = Json::array();
  for (const Json& found : summary.at("signatures")) {
    rows.push_back(signature_row(counts, found));
  }
  return rows;
}

void add_signatures(Json& report, const std::filesystem::path& directory, const Json& summary,
                    const CampaignCounts& counts) {
  for (const Json& found : summary.value("executor_mismatches", Json::array())) {
    report["missing"].push_back(
        fmt::format("On {} pairs {} gave different verdicts on the device and by its twin: one of the two is wrong.",
                    found.at("count").dump(), found.at("lane").get<std::string>()));
  }
  const Json kinds = fuzz::read_kinds(directory);
  if (kinds.is_null() && !summary["signatures"].empty())
    report["missing"].push_back(
        "The kinds of failure are not known yet: `graze minimize DIR` finds and explains them.");
  const std::size_t without = kinds.is_null() ? 0 : fuzz::signatures_without_kind(summary, kinds);
  if (without > 0)
    report["missing"].push_back(
        fmt::format("{} of {} signatures belong to no kind of failure: their lanes were not examined, run only on a "
                    "device, or did not fail again.",
                    without, summary["signatures"].size()));
  Json rows = Json::array(), cards = Json::array();
  std::size_t room = kMostMapBytes;
  Lacking lacking;
  std::map<std::size_t, std::vector<std::size_t>> cards_of;  // cards of each signature, the most frequent kind first
  for (const Json& kind : kinds) {
    if (cards.size() == fuzz::kMostShown) break;
    for (const Json& place : kind.at("places")) cards_of[place.get<std::size_t>()].push_back(cards.size());
    cards.push_back(card_of(directory, counts, summary.at("spec"), kind, room, lacking));
  }
  if (kinds.size() > cards.size())
    report["missing"].push_back(fmt::format("Cards show the most common {} of {} kinds; `graze failures` lists all.",
                                            cards.size(), kinds.size()));
  const std::size_t count = summary.at("signatures").size();
  for (std::size_t place = 0; place < std::min(count, kMostSignatures); ++place) {
    rows.push_back(signature_row(counts, summary.at("signatures")[place]));
    rows.back()["pairs"] = kept_pairs(directory, summary.at("spec"), summary.at("signatures")[place]);
    rows.back()["cards"] = cards_of[place];
  }
  if (rows.size() < count) {
    report["missing"].push_back(fmt::format(
        "The table shows the {} most common of {} signatures; signatures.csv lists all of them.", rows.size(), count));
  }
  say_what_is_missing(report["missing"], lacking, cards.size());
  report["sources"] = Json::object();
  for (const Json& card : cards) {
    const std::string algorithm = card["kind"]["subject"];
    for (const Json& row : card["snippets"]) {
      if (row["text"].get<std::string>().find(kSourceMark) != std::string::npos)
        report["sources"][algorithm] = amalgamated_source(algorithm);
    }
  }
  report["signature_count"] = count;
  report["signatures"] = std::move(rows);
  report["cards"] = std::move(cards);
}

}  // namespace graze::reports
