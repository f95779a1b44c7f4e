// SPDX-License-Identifier: Apache-2.0
#include "reports/league.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "analysis/convention.h"
#include "core/fnv1a.h"
#include "core/text.h"
#include "core/wilson.h"
#include "corpus/pair_format.h"
#include "fuzz/counts_json.h"
#include "fuzz/minimise/kinds.h"
#include "reports/plain_figures.h"
#include "reports/tables.h"
#include "reports/terminal.h"
#include "reports/text_table.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

Json counts_json(const fuzz::LeagueCounts& counts) {
  Json row{{"pairs", counts.pairs}};
  row.update(fuzz::counts_json(counts, true));
  row["clear"] = counts.clear;
  row["outside"] = counts.outside;
  row["not_repeated"] = counts.not_repeated;
  row["wrong"] = share_json(share_of(counts.wrong(), counts.pairs));
  return row;
}

Json row_json(const fuzz::LeagueRow& row) {
  Json groups = Json::object();
  fuzz::LeagueCounts total;
  std::uint64_t clear = 0;
  for (std::size_t g = 0; g < fuzz::kLeagueGroupCount; ++g) {
    if (row.groups[g].pairs + row.groups[g].outside == 0) continue;
    groups[std::string(fuzz::kLeagueGroups[g])] = counts_json(row.groups[g]);
    total += row.groups[g];
    if (g != static_cast<std::size_t>(fuzz::LeagueGroup::extreme)) clear += row.groups[g].clear;
  }
  return {{"lane", row.lane->id},
          {"subject", row.lane->info->id},
          {"foreign", row.lane->foreign},
          {"groups", groups},
          {"total", counts_json(total)},
          {"clear", clear},
          {"order_dependent", share_json(share_of(row.order_dependent, row.order_sample))},
          {"breaks_invariant", share_json(share_of(row.breaks_invariant, row.order_sample))},
          {"flips", row.flips ? Json(*row.flips) : Json()}};
}

// Returns null for a subject that states no facts about itself.
const LeagueSubject* find_subject(const std::vector<LeagueSubject>& subjects, std::string_view name) {
  const auto found = std::find_if(subjects.begin(), subjects.end(), [&](const auto& s) { return s.name == name; });
  return found == subjects.end() ? nullptr : &*found;
}

Json subject_json(const AlgorithmInfo& info, const Lane& lane, const std::vector<LeagueSubject>& subjects) {
  const LeagueSubject* found = find_subject(subjects, info.id);
  Json row{{"name", info.id}, {"foreign", lane.foreign}};
  if (!found) {
    row["source"] = info.paper;
    row["convention"] = fmt::format("coplanar: {}; degenerate: {}", info.coplanar, info.degenerate);
    return row;
  }
  row["what"] = found->what;
  row["version"] = found->version;
  row["source"] = found->source;
  row["outside"] = analysis::outside_in_words(lane.outside);
  row["convention"] = found->convention;
  return row;
}

// Writes a number so that it is read back exactly: as a decimal if a short one is exact, otherwise as a hex float.
std::string written(double value) {
  const double scaled = std::fabs(value) * 64;
  if (scaled < 1e7 && scaled == std::floor(scaled)) return fmt::format("{}", value);
  return corpus::hex_float(value);
}

std::string written(const AnyPair& pair) {
  std::string text;
  for (int i = 0; i < kCoordinates; ++i)
    text += (i == 0 ? "" : i % 9 == 0 ? "   " : i % 3 == 0 ? "  " : " ") + written(coordinates(pair.doubles)[i]);
  return text + (pair.floats ? "" : " | coordinates=f64");
}

Json failure_json(const fuzz::LeagueFailure& failure, const std::vector<LeagueSubject>& subjects) {
  const std::string_view subject = failure.lane->info->id;
  const LeagueSubject* found = find_subject(subjects, subject);
  const std::string of_subject = found ? fmt::format(" --subject {}", shell_word(found->name + '=' + found->what)) : "";
  return {{"subject", subject},
          {"lane", failure.lane->id},
          {"shape", failure.shape},
          {"truth", name(failure.truth.verdict)},
          {"contact", name(failure.truth.contact)},
          {"margin", failure.truth.margin},
          {"margin_ulps", failure.truth.margin_ulps},
          {"says", name(failure.verdict)},
          {"minimised", failure.minimised},
          {"pair", coordinates_of(failure.pair)},
          {"again", fmt::format("echo '{}' | graze check -{} --lanes {}", written(failure.pair), of_subject,
                                shell_word(failure.lane->id))},
          {"file", fmt::format("{:016x}.svg", fnv1a(fuzz::pair_text(failure.pair)))},
          {"drawing", drawing_of(failure.pair)}};
}

// Keeps only the allowed number of drawings.
void choose_drawings(Json& failures, const Json& rows) {
  std::set<std::string> foreign, files;
  for (const Json& row : rows) {
    if (row.at("foreign")) foreign.insert(row.at("subject"));
  }
  for (const bool library : {true, false}) {
    for (const char* shape : {"clear", "general", "coplanar", "degenerate"}) {
      for (Json& failure : failures) {
        if (failure.at("shape") != shape || foreign.contains(failure.at("subject")) != library) continue;
        const std::string file = failure.at("file");
        if (files.size() == kMostDrawings && !files.contains(file)) {
          failure["file"] = nullptr;
        } else {
          files.insert(file);
        }
      }
    }
  }
}

std::string negatives_and_positives(const Json& counts) {
  return counts.at("pairs") == 0 ? "-"
                                 : grouped(counts.at("false_negative")) + " / " + grouped(counts.at("false_positive"));
}

std::string nanoseconds_text(const Json& league, const Json& row) {
  const Json& value = league.at("timings").at("nanoseconds").at(row.at("lane").get<std::string>());
  if (value.is_null()) return "-";
  return fmt::format("{:.{}f}", value.get<double>(), value.get<double>() < 100 ? 1 : 0);
}

std::string count_of_sample(const Json& share) {
  return share.at("of") == 0 ? "-" : grouped(share.at("count")) + " of " + grouped(share.at("of"));
}

// A column after those of the groups: its title, and the function that returns its cell for a row.
struct Extra {
  const char* title;
  std::string (*text)(const Json& league, const Json& row);
};
constexpr Extra kExtras[] = {
    {"clear", [](const Json&, const Json& row) { return grouped(row.at("clear")); }},
    {"declined", [](const Json&, const Json& row) { return grouped(row.at("total").at("declined")); }},
    {"crashed", [](const Json&, const Json& row) { return grouped(row.at("total").at("crashed")); }},
    {"timed out", [](const Json&, const Json& row) { return grouped(row.at("total").at("timed_out")); }},
    {"unstable", [](const Json&, const Json& row) { return grouped(row.at("total").at("unstable")); }},
    {"not repeated", [](const Json&, const Json& row) { return grouped(row.at("total").at("not_repeated")); }},
    {"by convention",
     [](const Json&, const Json& row) {
       return row.at("total").at("outside") == 0 ? "-" : grouped(row.at("total").at("by_convention"));
     }},
    {"order", [](const Json&, const Json& row) { return count_of_sample(row.at("order_dependent")); }},
    {"invariants", [](const Json&, const Json& row) { return count_of_sample(row.at("breaks_invariant")); }},
    {"flips", [](const Json&, const Json& row) { return row.at("flips").is_null() ? "-" : grouped(row.at("flips")); }},
    {"ns a pair", nanoseconds_text},
};

std::string md(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != text.npos; at += 2) text.replace(at, 1, "\\|");
  return html(text);
}

std::string percent_text(const Json& share) {
  if (share.at("of") == 0) return "-";
  const auto percent = [](double x) {
    return x == 0 ? "0" : x < 1e-4 ? fmt::format("{:.4f}", 100 * x) : fmt::format("{:.3g}", 100 * x);
  };
  const double low = share.at("low"), high = share.at("high");
  return fmt::format("{} ({}…{})", percent(share.at("share")), rounded_down(100 * low, 3), rounded_up(100 * high, 3));
}

std::string table_line(const std::vector<std::string>& cells) {
  return fmt::format("| {} |\n", fmt::join(cells, " | "));
}

// The header of a table with one text column, followed by columns of numbers.
std::string table_head(const std::vector<std::string>& titles) {
  std::vector<std::string> rule(titles.size(), "---:");
  rule[0] = "---";
  return table_line(titles) + table_line(rule);
}

std::string page_counts(const Json& league) {
  std::vector<std::string> head{"lane"};
  for (const auto& [group, pairs] : league.at("groups").items())
    head.push_back(fmt::format("{}, {} pairs", group, grouped(pairs)));
  for (const Extra& extra : kExtras) head.push_back(extra.title);
  std::string text = table_head(head);
  for (const Json& row : league.at("rows")) {
    std::vector<std::string> cells{fmt::format("`{}`", row.at("lane").get<std::string>())};
    for (const auto& [group, pairs] : league.at("groups").items()) {
      const Json& counts = row.at("groups").at(group);
      cells.push_back(negatives_and_positives(counts));
      if (counts.at("pairs") != pairs && counts.at("pairs") != 0) cells.back() += " of " + grouped(counts.at("pairs"));
    }
    for (const Extra& extra : kExtras) cells.push_back(extra.text(league, row));
    text += table_line(cells);
  }
  return text;
}

std::string page_shares(const Json& league) {
  std::vector<std::string> head{"lane"};
  for (const auto& [group, pairs] : league.at("groups").items()) head.push_back(group);
  head.push_back("order-dependent");
  std::string text = table_head(head);
  for (const Json& row : league.at("rows")) {
    std::vector<std::string> cells{fmt::format("`{}`", row.at("lane").get<std::string>())};
    for (const auto& [group, pairs] : league.at("groups").items())
      cells.push_back(percent_text(row.at("groups").at(group).at("wrong")));
    cells.push_back(percent_text(row.at("order_dependent")));
    text += table_line(cells);
  }
  return text;
}

std::string page_subjects(const Json& league) {
  std::string text =
      "| subject | version | source | what its documentation states | excluded from its contract "
      "|\n|---|---|---|---|---|\n";
  for (const Json& subject : league.at("subjects")) {
    if (!subject.at("foreign")) continue;
    const auto field = [&](const char* key, const char* otherwise) {
      const std::string value = subject.at(key);
      return value.empty() ? otherwise : md(value);
    };
    text +=
        table_line({fmt::format("`{}`", subject.at("name").get<std::string>()), field("version", "not known"),
                    field("source", "not known"), field("convention", "nothing stated"), field("outside", "nothing")});
  }
  return text;
}

std::string wrong_in_words(const std::string& says) {
  return says == "disjoint"     ? "false negative"
         : says == "intersects" ? "false positive"
         : says == "timed_out"  ? "timed out"
                                : says;
}

std::string page_failures(const Json& league) {
  std::string text, subject;
  for (const Json& failure : league.at("failures")) {
    if (failure.at("subject") != subject) {
      subject = failure.at("subject");
      text += fmt::format("\n### {}\n", subject);
    }
    const std::string contact =
        failure.at("contact") == "none" ? "" : fmt::format(" (contact: {})", failure.at("contact").get<std::string>());
    const double ulps = failure.at("margin_ulps");
    const std::string says = failure.at("says");
    const std::string did = says == "crashed"     ? says
                            : says == "timed_out" ? "timed out"
                            : says == "unstable"  ? "is unstable"
                                                  : "returns " + says;
    text += fmt::format(
        "\n**{}, {}**: `{}` {}; the triangles {}{}; margin {:.4g}{}.{}\n", failure.at("shape").get<std::string>(),
        wrong_in_words(failure.at("says")), failure.at("lane").get<std::string>(), did,
        failure.at("truth") == "disjoint" ? "are disjoint" : "intersect", contact, failure.at("margin").get<double>(),
        ulps == 0 ? "" : fmt::format(" ({:.4g} ulps)", ulps), failure.at("minimised") ? "" : " Not minimised.");
    text += fmt::format("\n```sh\n{}\n```\n", failure.at("again").get<std::string>());
    if (!failure.at("file").is_null())
      text += fmt::format("\n![both triangles](league/{})\n", failure.at("file").get<std::string>());
  }
  return text;
}

}  // namespace

Json league_json(const fuzz::League& league, const std::vector<LeagueSubject>& subjects,
                 const std::vector<std::optional<double>>& nanoseconds, const std::string& machine,
                 const std::string& date) {
  Json groups = Json::object(), rows = Json::array(), failures = Json::array(), own = Json::array();
  for (std::size_t g = 0; g < fuzz::kLeagueGroupCount; ++g) {
    std::uint64_t pairs = 0;  // the number of pairs that a lane without a limit gets
    for (const fuzz::LeagueRow& row : league.rows) pairs = std::max(pairs, row.groups[g].pairs + row.groups[g].outside);
    if (pairs > 0) groups[std::string(fuzz::kLeagueGroups[g])] = pairs;
  }
  const AlgorithmInfo* last = nullptr;
  Json timings{{"machine", machine}, {"date", date}, {"nanoseconds", Json::object()}};
  for (std::size_t r = 0; r < league.rows.size(); ++r) {
    const Lane& lane = *league.rows[r].lane;
    rows.push_back(row_json(league.rows[r]));
    timings["nanoseconds"][lane.id] = nanoseconds[r] ? Json(std::round(*nanoseconds[r] * 10) / 10) : Json();
    if (lane.info != last) own.push_back(subject_json(*lane.info, lane, subjects));
    last = lane.info;
  }
  std::stable_sort(rows.begin(), rows.end(), [](const Json& l, const Json& r) {
    const auto key = [](const Json& row) {
      return std::pair<std::uint64_t, double>(row.at("clear"), row.at("total").at("wrong").at("share"));
    };
    return key(l) < key(r);
  });
  for (const bool foreign : {true, false}) {  // libraries first
    for (const fuzz::LeagueFailure& failure : league.failures) {
      if (failure.lane->foreign == foreign) failures.push_back(failure_json(failure, subjects));
    }
  }
  choose_drawings(failures, rows);
  Json json{{"seed", league.seed}, {"pairs", league.pairs}};
  if (league.in_doubles) json["coordinates"] = "f64";
  json.update({{"strata", league.strata},
               {"groups", groups},
               {"subjects", own},
               {"rows", rows},
               {"failures", failures},
               {"failures_not_repeated", league.failures_not_repeated},
               {"timings", timings}});
  return json;
}

std::map<std::string, std::string> league_drawings(const Json& league) {
  std::map<std::string, std::string> drawings;
  for (const Json& failure : league.at("failures")) {
    if (failure.at("file").is_null()) continue;
    std::string svg = pair_drawing(failure);
    // As a separate file, the drawing needs a background.
    svg.insert(svg.find('>') + 1, "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>");
    svg.insert(4, " xmlns=\"http://www.w3.org/2000/svg\"");
    drawings[failure.at("file")] = svg + "\n";
  }
  return drawings;
}

std::string league_table(const Json& league, const Screen& screen) {
  std::vector<Column> columns{{"lane", Align::left}};
  for (const auto& [group, pairs] : league.at("groups").items()) columns.push_back({group});
  std::vector<const Extra*> extras;  // only columns in which some row has a value
  for (const Extra& extra : kExtras) {
    const bool any = std::any_of(league.at("rows").begin(), league.at("rows").end(), [&](const Json& row) {
      const std::string text = extra.text(league, row);
      return text != "0" && text != "-";
    });
    if (!any) continue;
    extras.push_back(&extra);
    columns.push_back({extra.title});
  }
  TextTable table(columns);
  for (const Json& row : league.at("rows")) {
    std::vector<Cell> cells{row.at("lane").get<std::string>()};
    for (const auto& [group, pairs] : league.at("groups").items())
      cells.emplace_back(negatives_and_positives(row.at("groups").at(group)));
    for (const Extra* extra : extras) cells.emplace_back(extra->text(league, row));
    table.add(std::move(cells));
  }
  std::string pairs;
  for (const auto& [group, count] : league.at("groups").items())
    pairs += fmt::format("{}{} {}", pairs.empty() ? "" : ", ", group, grouped(count));
  return wrapped(
             fmt::format(
                 "False negatives / false positives within each lane's contract, on the same {} pairs ({}); slow lanes "
                 "decided only the first ones of each stratum.",
                 grouped(league.at("pairs")), pairs),
             screen.columns) +
         table.text(screen) +
         wrapped(fmt::format("{} smallest failures, each repeated in a fresh process; {} more were not repeated.",
                             league.at("failures").size(), grouped(league.at("failures_not_repeated"))),
                 screen.columns);
}

std::string league_page(const Json& league, const std::string& command) {
  return fmt::format(
      R"(# League: triangle-triangle tests of libraries, side by side

Made by `{command}`; do not edit. The {pairs} pairs are drawn in equal shares from the strata with seed {seed}{doubles}. All lanes decided the same pairs, but slow lanes only the first ones of each stratum. Lanes with the fewest clearly wrong verdicts come first.

CGAL's exact decision and `core/exact` determine the truth for every pair; GMP confirms it if a lane is wrong. Touching counts as intersecting, and a degenerate triangle is a segment or a point. If a library's documentation says nothing about such pairs, every difference counts as an error. Columns:

- **general** to **extreme**: false negatives / false positives in each group of strata. "near" has near pairs and exact contacts; "extreme" has needles, coordinates of extreme or very different sizes, and pairs far from the origin. "of N" gives the number of pairs that were counted, if it is smaller: slow lanes got only the first pairs of each stratum, and pairs outside a lane's contract do not count.
- **clear**: wrong verdicts, outside "extreme", on proper triangles that are not coplanar and whose margin is at least 2^{exponent} ulps of the largest coordinate. Neither a convention nor rounded input excuses them.
- **declined**: pairs on which the lane gave no answer. They are not wrong.
- **crashed**, **timed out**, **unstable**: pairs on which the lane failed, or did not always give the same verdict. They are wrong.
- **not repeated**: wrong verdicts that a fresh process did not repeat. They do not count as errors.
- **by convention**: verdicts that differ from the truth on pairs that the library's documentation leaves out of its contract. They do not count as errors.
- **order**: pairs of a sample on which the verdict changes with the order of triangles and vertices (72 orders with the same truth).
- **invariants**: pairs of the same sample on which the verdict changes under an exact mirror image, permutation of the axes, scaling or translation, or on which a part of a triangle intersects but the whole does not.
- **flips**: pairs on which the build with contraction gives a different verdict; only for lanes whose source can be built with contraction.
- **ns a pair**: the median of {repetitions} repetitions on {timed} pairs of `uniform`; the lanes take turns. The time is processor time of the subject's own process; {machine}, {date}.
- "-": not measured.

{counts}
## Shares
Wrong verdicts within the contract (false negatives, false positives, crashed, timed out and unstable), in per cent of the pairs within the contract, with 95 % intervals.

{shares}
## Subjects
{subjects}
## Smallest failures
These are the simplest pairs found, one for each subject, shape ("clear" as above, but including the strata in "extreme") and kind of wrong verdict. Run the commands in the folder in which `scripts/league` ran. `graze repro --emit` turns a pair into a program. CGAL and GMP confirmed each failure, and a fresh process repeated it; {not_repeated} others were not repeated and are left out. In the drawings, the second triangle is orange, the contact is red, and the line in which the planes meet is dashed.
{failures})",
      fmt::arg("command", command), fmt::arg("pairs", grouped(league.at("pairs"))),
      fmt::arg("doubles",
               league.contains("coordinates") ? ", with coordinates in double. Ulps are those of double" : ""),
      fmt::arg("seed", league.at("seed").get<std::uint64_t>()), fmt::arg("counts", page_counts(league)),
      fmt::arg("exponent", fuzz::kClearExponent), fmt::arg("repetitions", fuzz::kLeagueRepetitions),
      fmt::arg("timed", fuzz::kLeagueTimedPairs),
      fmt::arg("machine", league.at("timings").at("machine").get<std::string>()),
      fmt::arg("date", league.at("timings").at("date").get<std::string>()), fmt::arg("shares", page_shares(league)),
      fmt::arg("subjects", page_subjects(league)),
      fmt::arg("not_repeated", grouped(league.at("failures_not_repeated"))),
      fmt::arg("failures", page_failures(league)));
}

}  // namespace graze::reports
