// SPDX-License-Identifier: Apache-2.0
// Writes a campaign's results as CSV.
#include "reports/report.h"

#include <fmt/format.h>

#include <algorithm>

#include "fuzz/campaign/checked_summary.h"
#include "reports/failure_cards.h"
#include "reports/tables.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

// Formats a value as a cell. Null gives an empty cell, and text is quoted if necessary.
std::string cell(const Json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return value.dump();
  const std::string text = value;
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

struct Table {
  std::string text;
  explicit Table(const char* header) : text(std::string(header) + '\n') {}
  void row(const std::vector<Json>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) text += (i == 0 ? "" : ",") + cell(cells[i]);
    text += '\n';
  }
};

// The cells of a share: count, of, share, low, high.
void append(std::vector<Json>& cells, const Json& share) {
  for (const char* key : {"count", "of", "share", "low", "high"})
    cells.push_back(share.is_null() ? Json() : share[key]);
}

// The id of the row at this index of a list of the report; null if the index is null.
Json id_in(const Json& report, const char* list, const Json& place) {
  return place.is_null() ? place : report[list][place.get<std::size_t>()]["id"];
}

Json lane_id(const Json& report, const Json& row) { return id_in(report, "lanes", row["lane"]); }

// The id of a stratum's group; null for a stratum that this build does not know.
Json group_id(const Json& report, const Json& stratum) {
  for (const Json& group : report["groups"]) {
    const Json& strata = group["strata"];
    if (std::find(strata.begin(), strata.end(), stratum) != strata.end()) return group["id"];
  }
  return nullptr;
}

std::string rates_csv(const Json& report) {
  Table table("lane,group,stratum,kind,count,of,share,low,high");  // empty group and stratum: all strata together
  for (const Json& row : report["rates"]) {
    const Json stratum = id_in(report, "strata", row["stratum"]);
    const Json group = stratum.is_null() ? Json() : group_id(report, row["stratum"]);
    for (const char* kind : {"false_positive", "false_negative", "wrong", "differs_from_cpu"}) {
      if (row[kind].is_null()) continue;
      std::vector<Json> cells{lane_id(report, row), group, stratum, kind};
      append(cells, row[kind]);
      table.row(cells);
    }
    table.row({lane_id(report, row), group, stratum, "declined", row["declined"], nullptr, nullptr, nullptr, nullptr});
    if (row.contains("stored"))
      table.row({lane_id(report, row), group, stratum, "stored", row["stored"], nullptr, nullptr, nullptr, nullptr});
  }
  for (const Json& row : report["group_rates"]) {
    for (const char* kind : {"false_positive", "false_negative", "wrong"}) {
      if (!row.contains(kind)) continue;
      std::vector<Json> cells{lane_id(report, row), id_in(report, "groups", row["group"]), nullptr, kind};
      append(cells, row[kind]);
      table.row(cells);
    }
  }
  return table.text;
}

// Returns a row for each lane, stratum and bucket. differs: if true, counts the verdicts that differ from those of the
// lane's cpu lane, for lanes that have one; otherwise counts wrong verdicts.
std::string margins_csv(const CampaignCounts& counts, bool differs) {
  Table table("lane,stratum,side,exponent,count,of,share,low,high");
  for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
    if (differs && !counts.lanes[l].cpu) continue;
    for (const StratumCounts& stratum : counts.strata) {
      for (const auto& [bucket, found] : stratum.margins) {
        std::vector<Json> cells{counts.lanes[l].id, stratum.id, side_of(bucket),
                                bucket == 0 ? Json() : Json(exponent_of(bucket))};
        append(cells, to_json(share_of((differs ? found.differs_from_cpu : found.wrong)[l], found.pairs)));
        table.row(cells);
      }
    }
  }
  return table.text;
}

std::string thresholds_csv(const Json& report) {
  Table table("lane,group,stratum,side,exponent,above,bound");  // empty group and stratum: all strata together
  for (const Json& row : report["thresholds"]) {
    for (const char* side : {"disjoint", "intersects"}) {
      table.row({lane_id(report, row), id_in(report, "groups", row["group"]), id_in(report, "strata", row["stratum"]),
                 side, row[side]["exponent"], row[side]["above"], row[side]["bound"]});
    }
  }
  return table.text;
}

std::string extremes_csv(const Json& report) {
  Table table("kind,lane,exponent,step,count,of,share,low,high,times,times_low,times_high");
  for (const Json& row : report["extremes"]) {
    for (const Json& found : row["cells"]) {
      std::vector<Json> cells{row["kind"], lane_id(report, row), found["exponent"], row["step"]};
      append(cells, found["wrong"]);
      const Json times = found.value("times", Json::array({0, 0, nullptr}));
      cells.insert(cells.end(), times.begin(), times.end());
      table.row(cells);
    }
  }
  return table.text;
}

std::string signatures_csv(const Json& rows) {
  Table table("key,algorithm,count,share,contact,dimensions,coplanar,margin,marks");
  for (const Json& row : rows) {
    table.row({row["key"], row["algorithm"], row["count"], row["share"], row["contact"], row["dimensions"],
               row["coplanar"], row["margin"], row["marks"]});
  }
  return table.text;
}

std::string compare_csv(const Json& compare) {
  Table table("what,lane,stratum,key,before,before_low,before_high,after,after_low,after_high,changed,errors");
  for (const Json& row : compare["rates"]) {
    const Json &before = row["before"], &after = row["after"];
    std::vector<std::string> errors;
    for (const Json& error : row["errors"]) errors.push_back(error["error"]);
    table.row({"rate", row["lane"], row["stratum"], nullptr, before["share"], before["low"], before["high"],
               after["share"], after["low"], after["high"], row["changed"],
               fmt::format("{}", fmt::join(errors, "; "))});
  }
  const auto add = [&](const char* what) {
    for (const Json& row : compare[what]) {
      const bool gained = what == std::string_view("gained");
      table.row({std::string("kind ") + what, nullptr, nullptr, row["key"], gained ? Json() : row["count"], nullptr,
                 nullptr, gained ? row["count"] : Json(), nullptr, nullptr, nullptr, nullptr});
    }
  };
  add("gained");
  add("lost");
  return table.text;
}

}  // namespace

std::vector<CsvTable> csv_tables(const std::filesystem::path& directory, const Json& report) {
  const Json summary = fuzz::checked_summary(directory);
  const CampaignCounts counts = counts_of(summary);
  std::vector<CsvTable> tables{
      {"rates.csv", rates_csv(report)},           {"margins.csv", margins_csv(counts, false)},
      {"differs.csv", margins_csv(counts, true)}, {"thresholds.csv", thresholds_csv(report)},
      {"extremes.csv", extremes_csv(report)},     {"signatures.csv", signatures_csv(signature_rows(counts, summary))}};
  if (!report["compare"].is_null()) tables.push_back({"compare.csv", compare_csv(report["compare"])});
  return tables;
}

}  // namespace graze::reports
