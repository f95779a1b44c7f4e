// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <optional>

#include "reports/comparison.h"
#include "reports/extremes.h"
#include "reports/findings.h"
#include "reports/page.h"
#include "reports/plain_figures.h"
#include "reports/recorded_code.h"
#include "reports/terminal.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostRows = 500;  // rows of the table of signatures; signatures.csv has all

constexpr const char* kStyle = R"(pre { overflow-x: auto; border: 1px solid #8886; padding: 0.5rem; }
svg { max-width: 100%; } svg text { font-size: 9px; fill: currentColor; }
figure { display: inline-block; vertical-align: top; width: 20rem; margin: 0.5rem; }
)";

std::string paragraph(const std::string& text) { return "<p>" + html(text) + "</p>\n"; }

// The id of the lane that the row is about.
std::string lane_of(const Json& report, const Json& row) {
  return report.at("lanes").at(row.at("lane").get<std::size_t>()).at("id");
}

// A cell that is darker for larger shares; readable on light and dark backgrounds.
std::string share_cell(const Json& share) {
  const double value = share.at("share");
  return fmt::format(
      "<td class=\"number\" style=\"background: rgba(213, 94, 0, {:.3f})\" title=\"{} of {}, 95 % interval "
      "{} to {}\">{}</td>",
      0.75 * value, grouped(share.at("count")), grouped(share.at("of")), rate_words(share.at("low"), Bound::lower),
      rate_words(share.at("high"), Bound::upper), rate_words(value));
}

std::string answer_section(const Json& report, const Json& costs) {
  std::string text = "<h1>Graze: discrepancy report</h1>\n<h2>The answer</h2>\n<ol>\n";
  for (const Json& sentence : costs.is_null() ? report.at("answer") : costs.at("answer"))
    text += "<li>" + html(sentence) + "</li>\n";
  text += "</ol>\n";
  text += paragraph(
      "This page was built without Node or npm packages, so it lacks the interactive parts: sorting, filters, views "
      "that turn, ulp maps and copy buttons. The same data is in the JSON file and the CSV tables beside it.");
  for (const Json& sentence : report.at("missing")) text += paragraph(sentence);
  return text;
}

std::string run_section(const Json& report) {
  const Json& run = report.at("run");
  std::string text = "<h2>What was run</h2>\n";
  text += paragraph(fmt::format(
      "{} pairs, seed {}{}. Version {}, commit {}, {}; {}; {}.", grouped(run.at("pairs")), run.at("seed").dump(),
      run.at("complete") ? "" : ", not finished", run.at("build").at("version").get<std::string>(),
      run.at("build").at("commit").get<std::string>(), run.at("build").at("compiler").get<std::string>(),
      run.at("build").at("cuda").is_null() ? "no nvcc" : run.at("build").at("cuda").get<std::string>(),
      run.at("build").at("device").is_null() ? "no device" : run.at("build").at("device").get<std::string>()));
  if (!run.at("machine").is_null()) text += paragraph("Machine: " + run.at("machine").get<std::string>());
  for (const Json& subject : run.value("subjects", Json::array()))
    text += paragraph("Code of " + subject.at("name").get<std::string>() + ": " + code_words(subject));
  return text + "<pre>" + html(run.at("command")) + "</pre>\n";
}

std::string league(const Json& report) {
  std::string text = "<h2>Wrong verdicts by lane and stratum</h2>\n<div class=\"wide\"><table>\n<tr><th>lane</th>";
  std::vector<Json> columns{nullptr};
  text += "<th>all</th>";
  for (std::size_t s = 0; s < report.at("strata").size(); ++s) {
    if (report.at("strata").at(s).at("pairs") == 0) continue;
    columns.push_back(s);
    text += "<th>" + html(report.at("strata").at(s).at("id")) + "</th>";
  }
  text += "</tr>\n";
  for (std::size_t l = 0; l < report.at("lanes").size(); ++l) {
    text += "<tr><th>" + html(report.at("lanes").at(l).at("id")) + "</th>";
    for (const Json& column : columns) {
      const auto row = std::find_if(report.at("rates").begin(), report.at("rates").end(),
                                    [&](const Json& r) { return r.at("lane") == l && r.at("stratum") == column; });
      text += row == report.at("rates").end() ? "<td></td>" : share_cell((*row).at("wrong"));
    }
    text += "</tr>\n";
  }
  return text + "</table></div>\n";
}

// "general: from 2^3 ulps (rate below 0.1 %)" for each group of strata.
std::string threshold_words(const Json& report, const Json& lane, const char* side) {
  std::string text;
  for (const Json& row : report.at("thresholds")) {
    if (row.at("lane") != lane || row.at("group").is_null()) continue;
    const Json& t = row.at(side);
    text += (text.empty() ? "" : "; ") +
            report.at("groups")[row.at("group").get<std::size_t>()].at("id").get<std::string>() + ": " +
            (!t.at("exponent").is_null() ? fmt::format("from 2^{} ulps (rate below {})", t.at("exponent").dump(),
                                                       rate_words(t.at("bound"), Bound::upper))
             : t.at("largest").is_null() ? std::string("no pairs")
                                         : fmt::format("errors up to 2^{} ulps", t.at("largest").dump()));
  }
  return text;
}

std::string margin_section(const Json& report) {
  std::string text = "<h2>Share wrong against the exact margin</h2>\n";
  for (const Json& row : report.at("margins")) {
    text += fmt::format(
        "<figure>{}<figcaption>{}<br/>no error seen, disjoint: {}<br/>intersecting: {}</figcaption></figure>\n",
        margin_chart(row, "wrong"), html(lane_of(report, row)), threshold_words(report, row.at("lane"), "disjoint"),
        threshold_words(report, row.at("lane"), "intersects"));
  }
  return text;
}

// "up to 2^3 ulps apart", for the largest margin on that side at which verdicts differ; empty if no verdict does.
std::string farthest_words(const Json& row, const char* side, const char* words) {
  std::optional<int> most;
  for (const Json& point : row.at("points")) {
    if (point.at("side") != side || point.at("differs").at("count") == 0) continue;
    most = std::max(most.value_or(INT_MIN), point.at("exponent").get<int>() + 1);
  }
  return most ? fmt::format(", up to 2^{} ulps {}", *most, words) : "";
}

std::string differs_section(const Json& report) {
  std::string figures, equal;
  for (const Json& row : report.at("margins")) {
    const std::string lane = html(lane_of(report, row));
    std::uint64_t differs = 0, compared = 0;
    for (const Json& point : row.at("points")) {
      if (!point.contains("differs")) continue;
      differs += point.at("differs").at("count").get<std::uint64_t>();
      ++compared;
    }
    if (compared == 0) continue;
    if (differs == 0) {
      equal += (equal.empty() ? "" : ", ") + lane;
      continue;
    }
    figures += fmt::format("<figure>{}<figcaption>{}: {}{}{}</figcaption></figure>\n", margin_chart(row, "differs"),
                           lane, counted(differs, "pair"), farthest_words(row, "disjoint", "apart"),
                           farthest_words(row, "intersects", "deep"));
  }
  if (figures.empty() && equal.empty()) return "";
  return "<h2>Share of verdicts that differ from the cpu lane's, against the exact margin</h2>\n" + figures +
         (equal.empty() ? "" : "<p>Same verdict as the cpu lane on every pair: " + equal + ".</p>\n");
}

// Tables that show how the verdicts of each algorithm change with the toolchain.
std::string toolchains_section(const Json& map) {
  if (map.is_null()) return "";
  const std::string reference = html(map.at("reference"));
  std::string text = "<h2>Toolchains</h2>\n";
  for (const Json& sentence : map.at("sentences")) text += paragraph(sentence);
  for (const char* share : {"differs", "wrong"}) {
    text += (share == std::string_view("wrong") ? "<p>Verdicts that are wrong:</p>\n"
                                                : "<p>Verdicts that differ from " + reference + "'s:</p>\n") +
            "<div class=\"wide\"><table>\n<tr><th>algorithm</th>";
    for (const Json& variant : map.at("variants")) text += "<th>" + html(variant) + "</th>";
    text += "</tr>\n";
    for (const Json& row : map.at("rows")) {
      std::vector<std::string> cells(map["variants"].size(), "<td></td>");
      for (const Json& cell : row.at("cells")) {
        if (!cell.at(share).is_null()) cells.at(cell.at("variant").get<std::size_t>()) = share_cell(cell[share]);
      }
      text += fmt::format("<tr><th>{}/{}</th>{}</tr>\n", html(row.at("algorithm")), html(row.at("scalar")),
                          fmt::join(cells, ""));
    }
    text += "</table></div>\n";
  }
  return text;
}

// A cell that is darker if the lane errs more often there than at the origin.
std::string times_cell(const Json& cell) {
  const Json& share = cell.at("wrong");
  if (!cell.contains("times")) return fmt::format("<td class=\"number\">0</td>");
  const Json& times = cell.at("times");
  const bool at_least = times.at(0).is_null();
  const double shown = times.at(at_least ? 1 : 0);
  return fmt::format(
      "<td class=\"number\" style=\"background: rgba(213, 94, 0, {:.3f})\" title=\"{} of {}, {}; {} to {} times\">{}"
      "</td>",
      0.75 * std::clamp(std::log2(std::max(shown, 1.0)) / 5, 0.0, 1.0), grouped(share.at("count")),
      grouped(share.at("of")), rate_words(share.at("share")), times.at(1).dump(),
      times.at(2).is_null() ? "?" : times.at(2).dump(), fmt::format("{}{:.3g}", at_least ? "≥ " : "", shown));
}

// Describes, from pareto.json, up to which extremes lanes are as right as on ordinary pairs.
std::string shapes_section(const Json& pareto) {
  if (pareto.is_null())
    return "<p>To see how far lanes stay right on flat triangles and needles, run <code>graze pareto --out DIR</code> "
           "with this campaign's folder, then <code>graze report DIR</code>.</p>\n";
  std::string text = "<ul>\n";
  for (const Json& row : pareto.at("extremes")) {
    text += fmt::format("<li>{}, {}: {}</li>\n", html(row.at("lane")), html(row.at("extreme")), html(row.at("says")));
  }
  return "<h2>Scale, offset, flatness and needles, from graze pareto</h2>\n" + text + "</ul>\n";
}

std::string extremes_section(const Json& report, const Json& pareto) {
  std::string text;
  for (const Json& row : report.at("extremes")) {
    const std::string kind = row.at("kind");
    if (text.find("<h2>Wrong verdicts over " + kind) == std::string::npos) {
      text += (text.empty() ? "" : "</table></div>\n") +
              fmt::format("<h2>Wrong verdicts over {}, as multiples of those at {}</h2>\n<p>{}</p>\n", kind,
                          row.at("origin").is_null() ? "2^0" : "2^" + row.at("origin").dump(), kAsRightMeans) +
              "<div class=\"wide\"><table>\n<tr><th>lane</th><th>the lane is</th>";
      for (const Json& cell : row.at("cells")) text += "<th>2^" + cell.at("exponent").dump() + "</th>";
      text += "</tr>\n";
    }
    text += "<tr><th>" + html(lane_of(report, row)) + "</th>";
    text += "<td>" + html(row.at("says")) + "</td>";
    for (const Json& cell : row.at("cells")) text += times_cell(cell);
    text += "</tr>\n";
  }
  return (text.empty() ? "" : text + "</table></div>\n") + shapes_section(pareto);
}

std::string card(const Json& report, const Json& found) {
  const Json& kind = found.at("kind");
  std::string text = fmt::format("<h3>{}</h3>\n<figure>{}</figure>\n<pre>", html(kind.at("key")), pair_drawing(found));
  for (std::size_t i = 0; i < 18; ++i) {
    const auto coordinate = [&](const char* form) { return found.at("pair").at(form).at(i).get<std::string>(); };
    if (i % 3 == 0) text += fmt::format("{}[{}]", i < 9 ? 'a' : 'b', i / 3 % 3);
    text += fmt::format(" {} ({}){}", coordinate("decimal"), coordinate("hex"), i % 3 == 2 ? "\n" : "");
  }
  text +=
      "</pre>\n" + paragraph(fmt::format(
                       "{} pairs, judging by one pair of each signature; truth: {}, contact {}, margin {} ulps.",
                       grouped(kind.at("pairs")), found.at("truth").at("verdict").get<std::string>(),
                       found.at("truth").at("contact").get<std::string>(), found.at("truth").at("margin_ulps").dump()));
  std::string wrong;
  for (const Json& row : found.at("verdicts")) {
    if (row.at("wrong")) wrong += (wrong.empty() ? "" : ", ") + lane_of(report, row);
  }
  text += paragraph("Wrong: " + wrong);
  for (const Json& sentence : found.at("sentences")) text += paragraph(sentence);
  for (const Json& command : found.at("commands")) text += "<pre>" + html(command.at("text")) + "</pre>\n";
  return text;
}

std::string signature_section(const Json& report) {
  const std::size_t rows = std::min(report.at("signatures").size(), kMostRows);
  std::string text = fmt::format(
      "<h2>Signatures</h2>\n<p>{} in all; the table has the most common {}.</p>\n<div class=\"wide\"><table>\n"
      "<tr><th>signature</th><th>pairs</th></tr>\n",
      grouped(report.at("signature_count")), grouped(rows));
  for (std::size_t i = 0; i < rows; ++i) {
    text +=
        fmt::format("<tr><td>{}</td><td class=\"number\">{}</td></tr>\n", html(report.at("signatures").at(i).at("key")),
                    grouped(report.at("signatures").at(i).at("count")));
  }
  text += "</table></div>\n<h2>Cases</h2>\n";
  for (const Json& found : report.at("cards")) text += card(report, found);
  return text;
}

std::string compare_section(const Json& compare) {
  if (compare.is_null()) return "";
  std::string text = "<h2>What has changed</h2>\n<p>Since commit " +
                     html(compare.at("other").at("build").at("commit")) + ": " + html(compare.at("headline")) +
                     "</p>\n";
  for (const std::string& sentence : changed_sentences(compare)) text += paragraph(sentence);
  text +=
      "<p>Rates that changed:</p>\n"
      "<div "
      "class=\"wide\"><table>\n<tr><th>lane</th><th>stratum</th><th>before</th><th>after</th><th>changed</th></tr>\n";
  for (const Json& row : compare.at("rates")) {
    if (!row.at("changed")) continue;
    text += "<tr><td>" + html(row.at("lane")) + "</td><td>" + html(row.at("stratum")) + "</td>" +
            share_cell(row.at("before")) + share_cell(row.at("after")) + "<td>";
    for (const Json& error : row.at("errors"))
      text += (error == row["errors"][0] ? "" : ", ") + html(error.at("error"));
    text += "</td></tr>\n";
  }
  text += "</table></div>\n";
  if (!compare.at("kinds_compared")) return text;
  for (const char* what : {"gained", "lost"}) {
    text += fmt::format("<p>Kinds of failure {}: {}</p>\n<ul>\n", what, grouped(compare.at(what).size()));
    for (std::size_t i = 0; i < std::min(compare.at(what).size(), kMostRows); ++i)
      text += "<li>" + html(compare.at(what).at(i).at("key")) + "</li>\n";
    text += "</ul>\n";
  }
  return text;
}

// The sentences of graze tune, graze pareto and graze discrepancy. Their pictures are files beside the report.
std::string choices_section(const Json& choices) {
  std::string text;
  for (const auto& [name, title] : {std::pair{"tuned", "Which tolerance"}, {"pareto", "Errors against cost"}}) {
    if (choices.at(name).is_null()) continue;
    text += fmt::format("<h2>{}</h2>\n", title);
    for (const Json& sentence : choices.at(name).at("sentences")) text += paragraph(sentence);
  }
  if (const Json& values = choices.at("discrepancy"); !values.is_null()) {
    text += "<h2>CPU against GPU</h2>\n";
    for (const Json& sentence : values.at("sentences")) text += paragraph(sentence);
    text += fmt::format("<p><a href=\"{}\">Every value, with pictures</a></p>\n", html(values.at("page")));
  }
  return text;
}

constexpr const char* kDefinitions = R"(<h2>Definitions</h2>
<p>A triangle is the closed convex hull of its three stored points; touching counts as intersecting. Two exact methods decide
the truth. A lane is an algorithm in one precision on one target. cpu and cuda-nofma round every operation; in cpu-fma and
cuda-fma the compiler may fuse products into additions. The margin of a disjoint pair is its distance. The margin of an intersecting
pair is minus the length of the smallest translation that separates it, or 0 if an arbitrarily small one does. Its unit is the
ulp of the largest coordinate, in the coordinates' type. Intervals are Wilson's, with 95 % confidence. A signature is a way to fail: contact,
dimensions of both hulls, skew or coplanar, margin, algorithm, and a mark for each of the algorithm's lanes: + false positive,
- false negative, . right, _ not run.</p>
)";

}  // namespace

std::string plain_page(const Json& report, const Json& costs, const Json& choices) {
  return page_head("Graze: discrepancy report", kStyle) + answer_section(report, costs) +
         compare_section(report.at("compare")) + choices_section(choices) + league(report) +
         toolchains_section(report.value("toolchains", Json())) + margin_section(report) + differs_section(report) +
         extremes_section(report, choices.at("pareto")) + signature_section(report) + kDefinitions +
         run_section(report) + "</body>\n</html>\n";
}

}  // namespace graze::reports
