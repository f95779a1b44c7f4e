// SPDX-License-Identifier: Apache-2.0
#include "reports/failure_cards.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "analysis/signature.h"
#include "corpus/pair_format.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/minimise/carded_signatures.h"
#include "fuzz/minimise/case_facts.h"
#include "oracle/common_set.h"
#include "reports/snippet.h"
#include "reports/ulp_map_picture.h"

namespace graze::reports {

using fuzz::Json;
namespace {

// Throws: std::invalid_argument.
analysis::Signature signature_of(const std::string& key) {
  const std::optional<analysis::Signature> signature = analysis::parse_signature(key);
  if (!signature) throw std::invalid_argument("expected the key of a signature, found '" + key + "'");
  return *signature;
}

Json signature_row(const CampaignCounts& counts, const Json& found) {
  const std::string key = found.at("key");
  const analysis::Signature signature = signature_of(key);
  std::string marks;
  for (const ReportLane& lane : counts.lanes) {
    if (lane.name.subject == signature.subject) marks += signature.mark_of(lane.name.within_subject());
  }
  const double share = found.at("count").get<double>() / static_cast<double>(counts.total.pairs);
  return {{"key", key},
          {"algorithm", signature.subject},
          {"count", found.at("count")},
          {"share", std::stod(fmt::format("{:.5g}", share))},
          {"contact", name(signature.contact)},
          {"dimensions", fmt::format("{}{}", signature.shape.dimension_a, signature.shape.dimension_b)},
          {"coplanar", signature.shape.coplanar},
          {"margin", name_of_bucket(signature.bucket)},
          {"marks", marks},
          {"card", nullptr}};
}

std::string text_of(const corpus::Entry& entry, std::string_view key) {
  const std::string* value = corpus::field(entry, key);
  return value ? *value : "";
}

std::string origin(const corpus::Entry& entry) { return corpus::numbers_of(entry).value_or(text_of(entry, "from")); }

Json coordinates_of(const Pair& pair) {
  Json decimal = Json::array(), hex = Json::array(), value = Json::array();
  for (int i = 0; i < kCoordinates; ++i) {
    const float c = coordinates(pair)[i];
    decimal.push_back(fmt::format("{}", c));
    hex.push_back(corpus::hex_float(c));
    value.push_back(static_cast<double>(c));
  }
  return {{"decimal", decimal}, {"hex", hex}, {"value", value}};
}

Json drawing_of(const Pair& pair) {
  const auto points = [](const std::vector<Vec3<double>>& all) {
    Json rows = Json::array();
    for (const Vec3<double>& p : all) rows.push_back({p.x, p.y, p.z});
    return rows;
  };
  return {{"contact", points(oracle::common_set(pair))}, {"planes_line", points(oracle::planes_line(pair))}};
}

// What is stored beside the case, if it is of this pair.   Throws: FormatError when it is not what is stored there.
std::optional<Json> stored(const std::filesystem::path& file, const Pair& pair) {
  Json found = Json::parse(fuzz::read_whole(file), nullptr, false);
  if (!found.is_object() || found.value("pair", Json()) != fuzz::pair_text(pair)) return std::nullopt;
  const auto are_texts = [](const Json& values) {
    return std::all_of(values.begin(), values.end(), [](const Json& value) { return value.is_string(); });
  };
  const Json verdicts = found.value("verdicts", Json()), sentences = found.value("sentences", Json());
  if (!verdicts.is_object() || !sentences.is_array() || !are_texts(verdicts) || !are_texts(sentences))
    throw corpus::FormatError(file.string() + ": expected verdicts and sentences, found something else");
  return found;
}

double number_in(const std::filesystem::path& file, const corpus::Entry& entry, std::string_view key) {
  const std::string text = text_of(entry, key);
  std::size_t used = 0;
  try {
    const double value = std::stod(text, &used);
    if (used == text.size()) return value;
  } catch (const std::logic_error&) {
  }
  throw corpus::FormatError(
      fmt::format("{}:{}: expected a number as {}, found '{}'", file.string(), entry.line, key, text));
}

Verdict verdict_of(std::string_view word) {
  return word == name(Verdict::disjoint)     ? Verdict::disjoint
         : word == name(Verdict::intersects) ? Verdict::intersects
                                             : Verdict::declined;
}

Verdict marked(char mark, Verdict truth) {
  return mark == '+' ? Verdict::intersects : mark == '-' ? Verdict::disjoint : mark == '?' ? Verdict::declined : truth;
}

// Of the lanes that the minimiser ran on the pair; without its record, of those that the signature tells of.
Json verdicts_of(const CampaignCounts& counts, const analysis::Signature& signature, Verdict truth,
                 const std::optional<Json>& facts) {
  Json rows = Json::array();
  for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
    const ReportLane& lane = counts.lanes[l];
    std::optional<Verdict> verdict;
    if (facts && facts->at("verdicts").contains(lane.id)) {
      verdict = verdict_of(facts->at("verdicts")[lane.id].get<std::string>());
    } else if (lane.name.subject == signature.subject) {
      verdict = marked(signature.mark_of(lane.name.within_subject()), truth);
    }
    if (verdict) rows.push_back({{"lane", l}, {"verdict", name(*verdict)}, {"wrong", *verdict != truth}});
  }
  return rows;
}

Json commands_of(const corpus::Entry& entry, const analysis::Signature& signature, const std::string& from) {
  const std::string lanes = fmt::format("--lanes '{}/*'", signature.subject);
  const std::string file = fmt::format("echo '{}' > case.pairs", fuzz::pair_text(entry.pair));
  Json rows = Json::array();
  const auto add = [&](const char* label, const std::string& text) {
    rows.push_back({{"label", label}, {"text", text}});
  };
  add("repro", fmt::format("{}; graze repro case.pairs", file));
  add("explain", fmt::format("{}; graze explain case.pairs {}", file, lanes));
  add("map", fmt::format("{}; graze map case.pairs {}", file, lanes));
  if (from.find(':') != std::string::npos) add("minimize", fmt::format("graze minimize {} {}", from, lanes));
  return rows;
}

// A program that shows the first wrong lane, on the host if one of its lanes is; and the truth, by a few lines.
Json snippets_of(const CampaignCounts& counts, const corpus::Entry& entry, const analysis::Signature& signature,
                 Verdict truth, const Json& verdicts, const std::string& from) {
  Json rows = Json::array();
  const std::string name =
      fmt::format("Case {}{}: contact {}, margin {} ({} ulps)", corpus::field(entry, "kind") ? "minimised from " : "",
                  from, text_of(entry, "contact"), text_of(entry, "margin"), text_of(entry, "margin_ulps"));
  const auto add_lane = [&](SnippetKind kind) {
    for (const Json& row : verdicts) {
      const ReportLane& lane = counts.lanes[row["lane"].get<std::size_t>()];
      if (!row["wrong"].get<bool>() || !lane.row || lane.name.subject != signature.subject || !shows(kind, *lane.row))
        continue;
      const SnippetCase found{name, entry.pair, truth, lane.row, verdict_of(row["verdict"].get<std::string>())};
      rows.push_back({{"label", kSnippetKinds[static_cast<int>(kind)]}, {"text", snippet(kind, found)}});
      return true;
    }
    return false;
  };
  if (!add_lane(SnippetKind::cpp)) add_lane(SnippetKind::cuda);
  for (const SnippetKind kind : {SnippetKind::python, SnippetKind::obj}) {
    rows.push_back({{"label", kSnippetKinds[static_cast<int>(kind)]},
                    {"text", snippet(kind, {name, entry.pair, truth, nullptr, truth})}});
  }
  return rows;
}

// Cards that lack something.
struct Lacking {
  std::size_t minimised = 0, explained = 0, mapped = 0, room = 0;
};

// The maps stored with a case, as far as there is room for them; null without.
Json maps_of(const std::filesystem::path& case_file, const Pair& pair, std::size_t& room, Lacking& lacking) {
  const std::filesystem::path file = std::filesystem::path(case_file).replace_extension(".maps.json");
  Json maps = Json::parse(fuzz::read_whole(file), nullptr, false);
  if (!is_map_of(maps, pair)) {
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

Json card_of(const std::filesystem::path& directory, const CampaignCounts& counts, const Json& found, std::size_t& room,
             Lacking& lacking) {
  const std::string name_of_file = found.at("case");
  const std::filesystem::path file = fuzz::case_file(directory, found);
  const std::vector<corpus::Entry> entries = corpus::read_pairs(file);
  if (entries.empty()) throw corpus::FormatError(file.string() + ": expected at least one case, found none");
  const corpus::Entry& entry = fuzz::shown_case(entries);
  const analysis::Signature signature = signature_of(found.at("key"));
  const Verdict truth = verdict_of(text_of(entry, "truth"));
  const std::optional<Json> facts = stored(fuzz::facts_file(file), entry.pair);
  const bool minimised = corpus::field(entry, "kind") != nullptr;
  lacking.minimised += !minimised;
  lacking.explained += !facts;
  const std::string from = origin(entry);
  const Json verdicts = verdicts_of(counts, signature, truth, facts);
  return {{"signature", nullptr},
          {"file", name_of_file},
          {"minimised", minimised},
          {"from", from},
          {"pair", coordinates_of(entry.pair)},
          {"truth",
           {{"verdict", name(truth)},
            {"contact", text_of(entry, "contact")},
            {"margin", number_in(file, entry, "margin")},
            {"margin_ulps", number_in(file, entry, "margin_ulps")}}},
          {"drawing", drawing_of(entry.pair)},
          {"verdicts", verdicts},
          {"sentences", facts ? facts->at("sentences") : Json::array()},
          {"maps", maps_of(file, entry.pair, room, lacking)},
          {"commands", commands_of(entry, signature, from)},
          {"snippets", snippets_of(counts, entry, signature, truth, verdicts, from)}};
}

void say_what_is_missing(Json& missing, const Lacking& lacking, std::size_t cards) {
  if (lacking.minimised != 0) {
    missing.push_back(
        fmt::format("{} of {} cards show a pair as it was found: `graze minimize DIR` makes it simple, and "
                    "`graze report DIR` shows that.",
                    lacking.minimised, cards));
  }
  if (lacking.explained != 0) {
    missing.push_back(
        fmt::format("{} of {} cards have no explanation, and verdicts only of the algorithm that fails: "
                    "`graze minimize DIR` stores both.",
                    lacking.explained, cards));
  }
  if (lacking.mapped != 0) {
    missing.push_back(
        fmt::format("{} of {} cards have no ulp map: `graze minimize DIR` stores it.", lacking.mapped, cards));
  }
  if (lacking.room != 0) {
    missing.push_back(fmt::format("{} of {} cards show no ulp map, for want of room in one file; `graze map` draws it.",
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
  for (const Json& found : summary.value("executors_apart", Json::array())) {
    report["missing"].push_back(
        fmt::format("On {} pairs {} gave another verdict on the device than by its twin: one of the two is wrong.",
                    found.at("count").dump(), found.at("lane").get<std::string>()));
  }
  const std::vector<std::size_t> carded = fuzz::carded_signatures(summary);
  Json rows = Json::array(), cards = Json::array();
  std::size_t count = 0, room = kMostMapBytes;
  Lacking lacking;
  for (std::size_t place = 0; place < summary.at("signatures").size(); ++place) {
    const Json& found = summary.at("signatures")[place];
    ++count;
    const bool has_card = std::binary_search(carded.begin(), carded.end(), place);
    if (count > kMostSignatures && !has_card) continue;
    rows.push_back(signature_row(counts, found));
    if (!has_card) continue;
    rows.back()["card"] = cards.size();
    cards.push_back(card_of(directory, counts, found, room, lacking));
    cards.back()["signature"] = rows.size() - 1;
  }
  if (rows.size() < count) {
    report["missing"].push_back(
        fmt::format("The table shows the commonest {} of {} signatures; signatures.csv has all.", rows.size(), count));
  }
  say_what_is_missing(report["missing"], lacking, cards.size());
  report["signature_count"] = count;
  report["signatures"] = std::move(rows);
  report["cards"] = std::move(cards);
}

}  // namespace graze::reports
